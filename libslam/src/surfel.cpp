#include "surfel.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr double kUpright = 0.3;  // 1 − |n_z| of a surface that also holds the horizontal position: steeper than 45°

struct Cell {
  int x = 0, y = 0, z = 0;
  int count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::array<double, 6> products{};  // xx, xy, xz, yy, yz, zz
  double time_sum = 0, spin_sum = 0;
};

std::uint64_t mix(std::uint64_t h) {
  h ^= h >> 33, h *= 0xff51afd7ed558ccdULL, h ^= h >> 33, h *= 0xc4ceb9fe1a85ec53ULL, h ^= h >> 33;
  return h;
}

std::uint64_t cell_hash(int x, int y, int z) {
  return mix(static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) * 73856093u ^
             static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) * 19349663u ^
             static_cast<std::uint64_t>(static_cast<std::uint32_t>(z)) * 83492791u);
}

// Open addressing over cells in order of first touch, which depends on the points' order only.
class CellMap {
 public:
  explicit CellMap(std::size_t expected) {
    std::size_t capacity = 64;
    while (capacity < 2 * expected) capacity *= 2;
    slots_.assign(capacity, -1);
  }
  Cell& at(int x, int y, int z) {
    if (2 * (cells_.size() + 1) > slots_.size()) grow();
    std::size_t s = cell_hash(x, y, z) & (slots_.size() - 1);
    while (slots_[s] >= 0) {
      Cell& c = cells_[static_cast<std::size_t>(slots_[s])];
      if (c.x == x && c.y == y && c.z == z) return c;
      s = (s + 1) & (slots_.size() - 1);
    }
    slots_[s] = static_cast<int>(cells_.size());
    cells_.emplace_back();
    cells_.back().x = x, cells_.back().y = y, cells_.back().z = z;
    return cells_.back();
  }
  const std::vector<Cell>& cells() const { return cells_; }

 private:
  void grow() {
    slots_.assign(slots_.size() * 2, -1);
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      std::size_t s = cell_hash(cells_[k].x, cells_[k].y, cells_[k].z) & (slots_.size() - 1);
      while (slots_[s] >= 0) s = (s + 1) & (slots_.size() - 1);
      slots_[s] = static_cast<int>(k);
    }
  }
  std::vector<int> slots_;
  std::vector<Cell> cells_;
};

// Fits a plane to a cell; false where it is not planar enough (method: surfels).
bool fit(const Cell& cell, const Eigen::Vector3d& origin, const PoseTrack& track, const SurfelOptions& options,
         std::size_t level, Surfel& out, double& tilt) {
  if (cell.count < options.min_points) return false;
  const double n = cell.count;
  const Eigen::Vector3d mean = cell.sum / n;
  const auto& q = cell.products;
  Eigen::Matrix3d covariance;
  covariance << q[0], q[1], q[2], q[1], q[3], q[4], q[2], q[4], q[5];
  covariance = covariance / n - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(covariance);
  const Eigen::Vector3d values = eigen.eigenvalues();
  const double size = options.voxel_size_m[level];
  // A single scan line across a voxel has no second extent: its normal is noise.
  if (values[1] < options.min_extent_fraction * options.min_extent_fraction * size * size) return false;
  if (!(values[0] < options.max_eigenvalue_ratio * values[1])) return false;
  out.time_s = cell.time_sum / n;
  const Rigid3 pose = track.pose(out.time_s);
  const Eigen::Quaterniond inverse = pose.rotation.conjugate();
  const Eigen::Vector3d center = inverse * (mean + origin - pose.translation);
  tilt = 1 - std::abs(eigen.eigenvectors()(2, 0));
  Eigen::Vector3d normal = inverse * eigen.eigenvectors().col(0);
  if (normal.dot(center) > 0) normal = -normal;
  out.center = center.cast<float>();
  out.normal = normal.normalized().cast<float>();
  out.variance_m2 = static_cast<float>(std::max(values[0], 0.0));
  out.spin_rate_rad_s = static_cast<float>(cell.spin_sum / n);
  out.level = static_cast<std::uint8_t>(level);
  return true;
}

// A surfel with its rank: where a bin has too many, the lowest stay.
using Ranked = std::pair<std::uint64_t, Surfel>;

// Surfels of one voxel size from one of the two staggered grids.
std::vector<Ranked> extract_grid(std::span<const Eigen::Vector3d> world, std::span<const BodyPoint> points,
                                 const Eigen::Vector3d& origin, const PoseTrack& track, const SurfelOptions& options,
                                 std::size_t level, int stagger) {
  const double inverse_size = 1 / options.voxel_size_m[level], shift = 0.5 * stagger;
  std::vector<Ranked> found;
  CellMap map(points.size() / 8);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d c = world[k] * inverse_size;
    Cell& cell = map.at(static_cast<int>(std::floor(c.x() + shift)), static_cast<int>(std::floor(c.y() + shift)),
                        static_cast<int>(std::floor(c.z() + shift)));
    const Eigen::Vector3d p = world[k] - origin;
    cell.count++;
    cell.sum += p;
    std::size_t product = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) cell.products[product++] += p[i] * p[j];
    cell.time_sum += points[k].time_s;
    cell.spin_sum += static_cast<double>(points[k].spin_rate_rad_s);
  }
  for (const Cell& cell : map.cells()) {
    Surfel s;
    double tilt = 0;
    if (!fit(cell, origin, track, options, level, s, tilt)) continue;
    // Ground is plentiful and holds height, roll and pitch only: when there is too much, upright surfaces stay.
    const std::uint64_t rank = (tilt > kUpright ? std::uint64_t{0} : std::uint64_t{1} << 63) |
                               (cell_hash(cell.x, cell.y, 2 * cell.z + stagger) >> 1);
    found.emplace_back(rank, s);
  }
  return found;
}

}  // namespace

std::vector<Surfel> extract_surfels(std::span<const BodyPoint> points, const PoseTrack& track,
                                    const SurfelOptions& options, int threads) {
  std::vector<Surfel> out;
  if (points.empty()) return out;
  std::vector<Eigen::Vector3d> world(points.size());
  for (std::size_t k = 0; k < points.size(); ++k)
    world[k] = track.pose(points[k].time_s) * points[k].position.cast<double>();
  const Eigen::Vector3d origin = track.pose(points.front().time_s).translation;
  const std::size_t levels = options.voxel_size_m.size(), keep = static_cast<std::size_t>(options.max_surfels_per_bin);
  std::vector<std::vector<Ranked>> found(2 * levels);
  parallel_each(2 * levels, threads, [&](std::size_t k, int) {
    found[k] = extract_grid(world, points, origin, track, options, k / 2, static_cast<int>(k % 2));
  });
  for (std::size_t level = 0; level < levels; ++level) {
    std::vector<Ranked>& both = found[2 * level];
    both.insert(both.end(), found[2 * level + 1].begin(), found[2 * level + 1].end());
    if (both.size() > keep) {  // a fixed pseudo-random choice, even over space
      std::stable_sort(both.begin(), both.end(), [](const Ranked& a, const Ranked& b) { return a.first < b.first; });
      both.resize(keep);
    }
    for (const auto& [rank, surfel] : both) out.push_back(surfel);
  }
  std::stable_sort(out.begin(), out.end(), [](const Surfel& a, const Surfel& b) { return a.time_s < b.time_s; });
  return out;
}

}  // namespace rayfield::slam
