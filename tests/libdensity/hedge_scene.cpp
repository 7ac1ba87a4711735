#include "tests/libdensity/hedge_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rayfield::density::testing {
namespace {

constexpr double kCell = 0.08;
constexpr double kPi = std::numbers::pi;
using Eigen::Vector3d;

Vector3d random_direction(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  Vector3d v;
  do v = {normal(rng), normal(rng), normal(rng)};
  while (v.squaredNorm() < 1e-6);
  return v.normalized();
}

}  // namespace

Hedge::Hedge(const HedgeOptions& options) : options_(options) {
  std::mt19937_64 rng(options.seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  const auto target = static_cast<std::size_t>(options.leaf_area_per_m * options.length_m / options.leaf_size_m2);
  const auto accept = [&](double x) {
    if (x > options.missing_from_m && x < options.missing_to_m) return false;
    return uniform(rng) < (1 + options.variation * std::sin(2 * kPi * x / 4.5)) / (1 + options.variation);
  };
  while (leaves_.size() < target) {
    const double x = uniform(rng) * options.length_m;
    if (!accept(x)) continue;
    if (!options.shoots) {
      const double z = options.bottom_m + uniform(rng) * (options.top_m - options.bottom_m) + 0.08 * normal(rng);
      add_leaf({x, options.sigma_across_m * normal(rng), z}, rng);
      continue;
    }
    // A shoot: from the cordon upwards with some lean, a leaf every 6 cm on a petiole of 7 cm.
    const double foot_y = 0.4 * options.sigma_across_m * normal(rng);
    const double lean_x = 0.12 * normal(rng), lean_y = 0.9 * options.sigma_across_m * normal(rng);
    const double height = (options.top_m - options.bottom_m) * (0.75 + 0.35 * uniform(rng));
    for (double s = 0.02; s < height && leaves_.size() < target; s += 0.06) {
      const Vector3d node(x + lean_x * s / height, foot_y + lean_y * s / height, options.bottom_m + s);
      add_leaf(node + 0.07 * random_direction(rng), rng);
    }
  }
  build_grid();
}

void Hedge::add_leaf(const Vector3d& center, std::mt19937_64& rng) {
  const Vector3d normal = random_direction(rng);
  const Vector3d u = normal.cross(random_direction(rng)).normalized();
  const double half = std::sqrt(options_.leaf_size_m2) / 2;
  const Vector3d on_slope = center + Vector3d(0, 0, ground(center.x(), center.y()));
  leaves_.push_back({on_slope, half * u, half * normal.cross(u)});
}

void Hedge::build_grid() {
  for (const Leaf& leaf : leaves_) {
    const Vector3d reach = leaf.half_u.cwiseAbs() + leaf.half_v.cwiseAbs();
    box_.extend(Vector3d(leaf.center - reach)), box_.extend(Vector3d(leaf.center + reach));
  }
  for (const WoodCylinder& post : posts()) {
    const Vector3d reach(post.radius_m, post.radius_m, 0);
    box_.extend(Vector3d(post.base - reach)), box_.extend(Vector3d(post.base + post.length_m * post.axis + reach));
  }
  for (int k = 0; k < 3; ++k) n_[k] = std::max(1, static_cast<int>(std::ceil(box_.sizes()[k] / kCell)));
  const auto cells =
      static_cast<std::size_t>(n_[0]) * static_cast<std::size_t>(n_[1]) * static_cast<std::size_t>(n_[2]);
  cell_start_.assign(cells + 1, 0);
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<std::uint32_t> fill(cell_start_.begin(), cell_start_.end() - 1);
    for (std::uint32_t l = 0; l < leaves_.size(); ++l) {
      const Vector3d reach = leaves_[l].half_u.cwiseAbs() + leaves_[l].half_v.cwiseAbs();
      int lo[3], hi[3];
      for (int k = 0; k < 3; ++k) {
        lo[k] = std::clamp(static_cast<int>((leaves_[l].center[k] - reach[k] - box_.min()[k]) / kCell), 0, n_[k] - 1);
        hi[k] = std::clamp(static_cast<int>((leaves_[l].center[k] + reach[k] - box_.min()[k]) / kCell), 0, n_[k] - 1);
      }
      for (int z = lo[2]; z <= hi[2]; ++z)
        for (int y = lo[1]; y <= hi[1]; ++y)
          for (int x = lo[0]; x <= hi[0]; ++x) {
            const auto cell =
                (static_cast<std::size_t>(z) * static_cast<std::size_t>(n_[1]) + static_cast<std::size_t>(y)) *
                    static_cast<std::size_t>(n_[0]) +
                static_cast<std::size_t>(x);
            if (pass == 0)
              ++cell_start_[cell + 1];
            else
              cell_leaf_[fill[cell]++] = l;
          }
    }
    if (pass == 0) {
      for (std::size_t c = 0; c < cells; ++c) cell_start_[c + 1] += cell_start_[c];
      cell_leaf_.resize(cell_start_.back());
    }
  }
}

double Hedge::leaf_area(double from_m, double to_m) const {
  double sum = 0;
  for (const Leaf& leaf : leaves_)
    if (leaf.center.x() >= from_m && leaf.center.x() < to_m) sum += options_.leaf_size_m2;
  return sum;
}

std::vector<WoodCylinder> Hedge::posts() const {
  std::vector<WoodCylinder> out;
  if (options_.post_every_m <= 0) return out;
  for (double x = 0; x <= options_.length_m + 1e-9; x += options_.post_every_m)
    out.push_back({1, {x, 0, ground(x, 0)}, Vector3d::UnitZ(), options_.post_radius_m, options_.post_height_m});
  return out;
}

double Hedge::cast(const Vector3d& o, const Vector3d& d) const {
  double t0 = 0, t1 = 1e9;
  for (int k = 0; k < 3; ++k) {
    const double inv = 1 / (d[k] == 0 ? 1e-300 : d[k]);
    const double a = (box_.min()[k] - o[k]) * inv, b = (box_.max()[k] - o[k]) * inv;
    t0 = std::max(t0, std::min(a, b)), t1 = std::min(t1, std::max(a, b));
  }
  double best = 1e9;
  for (const WoodCylinder& post : posts()) {
    double in, out;
    if (shell_interval(post, 0, o, d, in, out) && in > 0) best = std::min(best, in);
  }
  if (t0 < t1) {
    const Vector3d g = (o + t0 * d - box_.min()) / kCell;
    int i[3];
    double next[3];
    for (int k = 0; k < 3; ++k) {
      i[k] = std::clamp(static_cast<int>(g[k]), 0, n_[k] - 1);
      next[k] = d[k] == 0 ? 1e18 : t0 + ((d[k] > 0 ? i[k] + 1 : i[k]) - g[k]) * kCell / d[k];
    }
    for (;;) {
      const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
      const auto cell =
          (static_cast<std::size_t>(i[2]) * static_cast<std::size_t>(n_[1]) + static_cast<std::size_t>(i[1])) *
              static_cast<std::size_t>(n_[0]) +
          static_cast<std::size_t>(i[0]);
      for (std::uint32_t at = cell_start_[cell]; at < cell_start_[cell + 1]; ++at) {
        const Leaf& leaf = leaves_[cell_leaf_[at]];
        const Vector3d normal = leaf.half_u.cross(leaf.half_v);
        const double dn = d.dot(normal);
        if (std::abs(dn) < 1e-12) continue;
        const double t = (leaf.center - o).dot(normal) / dn;
        if (t <= 0 || t >= best) continue;
        const Vector3d q = o + t * d - leaf.center;
        const double side2 = leaf.half_u.squaredNorm();
        if (std::abs(q.dot(leaf.half_u)) <= side2 && std::abs(q.dot(leaf.half_v)) <= side2) best = t;
      }
      if (next[axis] >= t1 || best < next[axis]) break;
      i[axis] += d[axis] > 0 ? 1 : -1;
      if (i[axis] < 0 || i[axis] >= n_[axis]) break;
      next[axis] += kCell / std::abs(d[axis]);
    }
  }
  return best < 1e8 ? best : -1;
}

tile::SegmentBatch Hedge::scan(const ScanOptions& scan) const {
  tile::SegmentBatch out;
  std::mt19937_64 rng(scan.seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  const Eigen::AlignedBox3d wide(Vector3d(box_.min().array() - 0.5), Vector3d(box_.max().array() + 0.5));
  for (int side = 0; side < (scan.both_sides ? 2 : 1); ++side) {
    const double y = side == 0 ? -scan.lane_distance_m : scan.lane_distance_m;
    const double duration = (options_.length_m + 8) / scan.speed_m_s, phase = uniform(rng);
    const auto beams = static_cast<std::int64_t>(duration * scan.beams_per_s);
    for (std::int64_t b = 0; b < beams; ++b) {
      const double t = static_cast<double>(b) / scan.beams_per_s;
      const double x = -4 + scan.speed_m_s * t;
      const double elevation = 2 * kPi * (t * scan.lines_per_s + phase), spin = 2 * kPi * (scan.spin_hz * t + phase);
      const Vector3d o(x, y, ground(x, y) + scan.sensor_height_m + 0.03 * std::sin(2.1 * t));
      const Vector3d d(std::cos(elevation) * std::cos(spin), std::cos(elevation) * std::sin(spin), std::sin(elevation));
      double t0 = 0, t1 = 8;
      for (int k = 0; k < 3; ++k) {
        const double inv = 1 / (d[k] == 0 ? 1e-300 : d[k]);
        const double a = (wide.min()[k] - o[k]) * inv, c = (wide.max()[k] - o[k]) * inv;
        t0 = std::max(t0, std::min(a, c)), t1 = std::min(t1, std::max(a, c));
      }
      const bool near = t0 < t1;
      if (!near && !scan.everything) continue;
      const double range = near ? cast(o, d) : -1;
      const bool hit = range > 0 && range < 8;
      out.entry.push_back(o);
      out.exit.push_back(o + d * (hit ? range + scan.range_noise_m * normal(rng) : scan.everything ? 40.0 : 8.0));
      out.time_s.push_back(1.5e9 + t + side * duration);
      out.intensity.push_back(hit ? 100 : 0);
      out.flags.push_back(static_cast<std::uint8_t>(tile::kStartsHere | tile::kEndsHere | (hit ? tile::kHit : 0)));
    }
  }
  return out;
}

std::vector<RowSegment> Hedge::row_segments(double voxel_m, double half_width_m, double top_m) const {
  const int per = std::max(1, static_cast<int>(std::lround(3.0 / voxel_m)));
  const int first = -static_cast<int>(std::ceil(0.6 / voxel_m));
  const int last = static_cast<int>(std::ceil((options_.length_m + 0.6) / voxel_m));
  const int half = static_cast<int>(std::ceil(half_width_m / voxel_m - 1e-9));
  std::vector<RowSegment> out;
  for (int column = first; column < last; column += per) {
    RowSegment s;
    s.row = 1, s.index = static_cast<int>(out.size());
    s.chainage_m = column * voxel_m;
    s.origin = {s.chainage_m, 0};
    s.ground_m = ground(s.chainage_m, 0), s.slope_along = options_.slope_x, s.slope_across = options_.slope_y;
    s.first_along = column, s.n_along = std::min(per, last - column), s.n_across = 2 * half;
    s.n_up = static_cast<int>(std::ceil((top_m - 0.3) / voxel_m - 1e-9));
    s.across_min_m = -half * voxel_m, s.up_min_m = 0.3, s.voxel_m = voxel_m;
    out.push_back(s);
  }
  return out;
}

}  // namespace rayfield::density::testing
