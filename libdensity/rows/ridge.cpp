#include "libdensity/rows/ridge.h"

#include <algorithm>
#include <cmath>

#include "libdensity/layout/polyline.h"
#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

constexpr double kStep = 0.5;   // m, between vertices of a trace
constexpr double kPatch = 0.1;  // m, between samples of the map

Eigen::Vector2d left_of(const Eigen::Vector2d& u) { return {-u.y(), u.x()}; }

// Mean canopy over a rectangle centred at p, half sizes along u and across.
double patch_mean(const CanopyMap& canopy, const Eigen::Vector2d& p, const Eigen::Vector2d& u, double along,
                  double across, double shift = 0) {
  const Eigen::Vector2d n = left_of(u);
  const int na = round_int(along / kPatch), nc = round_int(across / kPatch);
  double sum = 0;
  for (int a = -na; a <= na; ++a)
    for (int c = -nc; c <= nc; ++c) sum += canopy_at(canopy, p + u * (a * kPatch) + n * (shift + c * kPatch));
  return sum / ((2 * na + 1) * (2 * nc + 1));
}

bool is_tall(const CanopyMap& canopy, const Eigen::Vector2d& p, const Eigen::Vector2d& u) {
  const Eigen::Vector2d n = left_of(u);
  int tall = 0, total = 0;
  for (int a = -2; a <= 2; ++a)
    for (int c = -3; c <= 3; ++c) {
      ++total;
      if (canopy.hits(CanopyLayer::tall, p + u * (a * kPatch) + n * (c * kPatch)) > 0) ++tall;
    }
  return 4 * tall > total;
}

// Offset of the canopy's centre of mass from p, within ±reach across and ±along; 0 without canopy.
double centroid_offset(const CanopyMap& canopy, const Eigen::Vector2d& p, const Eigen::Vector2d& u, double along,
                       double reach) {
  const Eigen::Vector2d n = left_of(u);
  const int na = round_int(along / kPatch), nc = round_int(reach / kPatch);
  double sum = 0, weight = 0;
  for (int c = -nc; c <= nc; ++c)
    for (int a = -na; a <= na; ++a) {
      const double w = canopy_at(canopy, p + u * (a * kPatch) + n * (c * kPatch));
      sum += w * c * kPatch;
      weight += w;
    }
  return weight > 0 ? sum / weight : 0.0;
}

// Steps from the front of `line` onwards; stops after max_gap_m without canopy and drops that gap.
void follow(std::vector<Eigen::Vector2d>& line, const Eigen::Vector2d& start_direction, double threshold,
            const CanopyMap& canopy, const RowOptions& options) {
  constexpr std::size_t kBaseline = 12;  // vertices: six metres fix the direction
  constexpr double kLongest = 3000;      // m; a bound on what one trace can be
  std::size_t last_seen = line.size();
  const std::size_t limit = line.size() + static_cast<std::size_t>(kLongest / kStep);
  while (line.size() < limit) {
    Eigen::Vector2d u = start_direction;
    if (line.size() > kBaseline) u = (line.back() - line[line.size() - 1 - kBaseline]).normalized();
    Eigen::Vector2d p = line.back() + kStep * u;
    const bool seen = patch_mean(canopy, p, u, 0.2, options.half_width_m) >= threshold && !is_tall(canopy, p, u);
    if (seen) {
      const double shift = centroid_offset(canopy, p, u, 0.7, options.half_width_m + 0.1);
      p += left_of(u) * (0.4 * shift);
    }
    line.push_back(p);
    if (seen) last_seen = line.size();
    if (static_cast<double>(line.size() - last_seen) * kStep > options.max_gap_m) break;
  }
  line.resize(last_seen);
}

// Moves every vertex to the canopy's centre and smooths the line across its chord. Where there is no canopy the line
// bridges the gap with constant change of curvature, whatever the trace did there.
std::vector<Eigen::Vector2d> centred(const std::vector<Eigen::Vector2d>& line, const CanopyMap& canopy,
                                     const RowOptions& options) {
  const Eigen::Vector2d normal = left_of((line.back() - line.front()).normalized());
  std::vector<double> across, weights;
  std::vector<Eigen::Vector2d> out;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const std::size_t a = i >= 4 ? i - 4 : 0, b = std::min(i + 4, line.size() - 1);
    const Eigen::Vector2d u = (line[b] - line[a]).normalized();
    const double shift = centroid_offset(canopy, line[i], u, 0.5, options.half_width_m + 0.2);
    out.push_back(line[i] + left_of(u) * shift);
    across.push_back((out.back() - line.front()).dot(normal));
    weights.push_back(patch_mean(canopy, line[i], u, 0.2, options.half_width_m));
  }
  const double stiffness = std::pow(options.smoothing_m / (2 * M_PI * kStep), 6) * 0.3;
  const std::vector<double> smooth = smooth_values(across, weights, stiffness, 0.3);
  for (std::size_t i = 0; i < line.size(); ++i) out[i] += normal * (smooth[i] - across[i]);
  return out;
}

// Puts the ends where the canopy ends, to a cell.
std::vector<Eigen::Vector2d> trimmed(const std::vector<Eigen::Vector2d>& line, const CanopyMap& canopy) {
  const double length = polyline_length(line);
  const auto occupied = [&](double chainage) {
    const LinePoint at = point_at(line, chainage);
    int cells = 0;
    for (int c = -2; c <= 2; ++c)
      if (canopy.hits(CanopyLayer::canopy, at.position + left_of(at.direction) * (c * kPatch)) >= 3) ++cells;
    return cells >= 1;
  };
  double start = 0.5, end = length - 0.5;
  while (start > -0.5 && (occupied(start - 0.1) || occupied(start - 0.2))) start -= 0.1;
  while (end < length + 0.5 && (occupied(end + 0.1) || occupied(end + 0.2))) end += 0.1;
  return resampled(sub_line(line, start, end), kStep);
}

void measure(Ridge& ridge, const CanopyMap& canopy, double threshold, const RowOptions& options) {
  double core = 0, left = 0, right = 0;
  int covered = 0, tall = 0;
  const double lane = std::abs(ridge.offset_m);
  for (std::size_t i = 0; i < ridge.line.size(); ++i) {
    const std::size_t a = i > 0 ? i - 1 : 0, b = std::min(i + 1, ridge.line.size() - 1);
    const Eigen::Vector2d u = (ridge.line[b] - ridge.line[a]).normalized();
    const double here = patch_mean(canopy, ridge.line[i], u, 0.2, options.half_width_m);
    core += here;
    left += patch_mean(canopy, ridge.line[i], u, 0.2, 0.2, lane);
    right += patch_mean(canopy, ridge.line[i], u, 0.2, 0.2, -lane);
    if (here >= threshold) ++covered;
    if (is_tall(canopy, ridge.line[i], u)) ++tall;
  }
  const double n = static_cast<double>(ridge.line.size());
  ridge.strength = core / n;
  ridge.cover = covered / n;
  ridge.tall_share = tall / n;
  ridge.lane_share = core > 0 ? std::max(left, right) / core : 1;
}

}  // namespace

double canopy_at(const CanopyMap& canopy, const Eigen::Vector2d& p) {
  return std::min(canopy.hits(CanopyLayer::canopy, p), 8) / 8.0;
}

std::vector<RidgeSeed> find_seeds(const Pass& pass, const CanopyMap& canopy, const RowOptions& options) {
  constexpr double kBin = 0.1;
  const int bins = round_int((options.max_offset_m + 0.5) / kBin);
  const std::size_t window = static_cast<std::size_t>(std::lround(8.0 / options.passes.spacing_m));
  std::vector<RidgeSeed> seeds;
  const std::size_t n = pass.line.size();
  for (std::size_t begin = 0; begin + 2 < n; begin += window) {
    const std::size_t end = std::min(begin + window, n - 1);
    const std::size_t middle = (begin + end) / 2;
    const Eigen::Vector2d u = (pass.line[end] - pass.line[begin]).normalized();
    for (int side : {1, -1}) {
      std::vector<double> profile(static_cast<std::size_t>(bins) + 1, 0.0);
      for (std::size_t j = begin; j <= end; ++j)
        for (std::size_t b = 0; b < profile.size(); ++b)
          profile[b] += patch_mean(canopy, pass.line[j], u, 0.2, 0.1, side * static_cast<double>(b) * kBin) /
                        static_cast<double>(end - begin + 1);
      const std::size_t first = static_cast<std::size_t>(std::lround(options.min_offset_m / kBin));
      const double highest = *std::max_element(profile.begin() + static_cast<std::ptrdiff_t>(first), profile.end());
      if (highest < 0.02) continue;
      // The nearest principal peak: higher than all within 0.4 m, and than 0.4 of the highest.
      for (std::size_t b = first; static_cast<double>(b) * kBin <= options.max_offset_m + 1e-9 && b < profile.size();
           ++b) {
        const std::size_t lo = b >= 4 ? b - 4 : 0, hi = std::min(b + 4, profile.size() - 1);
        if (profile[b] < 0.4 * highest ||
            profile[b] < *std::max_element(profile.begin() + static_cast<std::ptrdiff_t>(lo),
                                           profile.begin() + static_cast<std::ptrdiff_t>(hi) + 1))
          continue;
        const double offset = side * static_cast<double>(b) * kBin;
        seeds.push_back({pass.line[middle] + left_of(u) * offset, u, offset, profile[b]});
        break;
      }
    }
  }
  return seeds;
}

std::optional<Ridge> trace_ridge(const RidgeSeed& seed, const CanopyMap& canopy, const RowOptions& options) {
  const double threshold = 0.2 * seed.strength;
  Eigen::Vector2d start = seed.position;
  for (int i = 0; i < 3; ++i)
    start += left_of(seed.direction) * centroid_offset(canopy, start, seed.direction, 2.0, options.half_width_m + 0.1);

  std::vector<Eigen::Vector2d> forward{start};
  follow(forward, seed.direction, threshold, canopy, options);
  Eigen::Vector2d back = -seed.direction;
  if (forward.size() > 12) back = (forward.front() - forward[12]).normalized();
  std::vector<Eigen::Vector2d> line(forward.rbegin(), forward.rend());
  follow(line, back, threshold, canopy, options);
  if (static_cast<double>(line.size()) * kStep < options.min_length_m) return std::nullopt;

  Ridge ridge;
  ridge.offset_m = seed.offset_m;
  ridge.line = resampled(line, kStep);
  ridge.line = resampled(centred(ridge.line, canopy, options), kStep);
  ridge.line = resampled(centred(ridge.line, canopy, options), kStep);
  ridge.line = trimmed(ridge.line, canopy);
  if (polyline_length(ridge.line) < options.min_length_m) return std::nullopt;
  measure(ridge, canopy, threshold, options);
  return ridge;
}

}  // namespace rayfield::density
