#include "libslam/surfels/surfel.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "libslam/surfels/pole_detection.h"
#include "libslam/surfels/voxel_map.h"
#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr double kUpright =
    0.3;  // 1 − |n_z| of a surface that also constrains the horizontal position: steeper than 45°

// Fits a plane to the points of a voxel; false if they are not planar enough, or lit so aslant that their ranges are
// not those of the plane (docs/slam.md, "Stage a: windows").
bool fit(const VoxelSums& voxel, const Eigen::Vector3d& origin, const BeamSource& source, const PoseTrack& track,
         const SurfelOptions& options, std::size_t level, Surfel& out, double& tilt) {
  if (voxel.count < options.min_points) return false;
  const double n = voxel.count;
  const Eigen::Vector3d mean = voxel.mean();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(voxel.covariance());
  const Eigen::Vector3d values = eigen.eigenvalues();
  const double size = options.voxel_size_m[level];
  // A single scan line across a voxel has no second extent: its normal is noise.
  if (values[1] < options.min_extent_fraction * options.min_extent_fraction * size * size) return false;
  if (!(values[0] < options.max_eigenvalue_ratio * values[1])) return false;
  out.time_s = voxel.time_sum / n;
  const Rigid3 pose = track.pose(out.time_s);
  const Eigen::Quaterniond inverse = pose.rotation.conjugate();
  const Eigen::Vector3d center = inverse * (mean + origin - pose.translation);
  tilt = 1 - std::abs(eigen.eigenvectors()(2, 0));
  Eigen::Vector3d normal = inverse * eigen.eigenvectors().col(0);
  if (normal.dot(center) > 0) normal = -normal;
  if (!(source.spot_depth_m(center, normal) <= options.max_spot_depth_m)) return false;
  out.center = center.cast<float>();
  out.normal = normal.normalized().cast<float>();
  out.variance_m2 = static_cast<float>(std::max(values[0], 0.0));
  out.spin_rate_rad_s = static_cast<float>(voxel.spin_sum / n);
  out.level = static_cast<std::uint8_t>(level);
  return true;
}

// A surfel with its rank: where a bin has too many, the lowest stay.
using Ranked = std::pair<std::uint64_t, Surfel>;

// The points in one of the two staggered grids of a voxel size.
VoxelMap fill_grid(std::span<const Eigen::Vector3d> world, std::span<const BodyPoint> points,
                   const Eigen::Vector3d& origin, double voxel_size_m, int stagger) {
  const double inverse_size = 1 / voxel_size_m, shift = 0.5 * stagger;
  VoxelMap map(points.size() / 8);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector3d c = world[k] * inverse_size;
    VoxelSums& voxel = map.at(static_cast<int>(std::floor(c.x() + shift)), static_cast<int>(std::floor(c.y() + shift)),
                              static_cast<int>(std::floor(c.z() + shift)));
    const Eigen::Vector3d p = world[k] - origin;
    voxel.count++;
    voxel.sum += p;
    std::size_t product = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) voxel.products[product++] += p[i] * p[j];
    voxel.time_sum += points[k].time_s;
    voxel.spin_sum += static_cast<double>(points[k].spin_rate_rad_s);
  }
  return map;
}

// Surfels of one such grid.
std::vector<Ranked> surfels_of(const VoxelMap& map, const Eigen::Vector3d& origin, const BeamSource& source,
                               const PoseTrack& track, const SurfelOptions& options, std::size_t level, int stagger) {
  std::vector<Ranked> found;
  for (const VoxelSums& voxel : map.voxels()) {
    Surfel s;
    double tilt = 0;
    if (!fit(voxel, origin, source, track, options, level, s, tilt)) continue;
    // Ground is plentiful and constrains height, roll and pitch only: where surfels are too many, upright ones stay.
    const std::uint64_t rank = (tilt > kUpright ? std::uint64_t{0} : std::uint64_t{1} << 63) |
                               (voxel_hash(voxel.x, voxel.y, 2 * voxel.z + stagger) >> 1);
    found.emplace_back(rank, s);
  }
  return found;
}

}  // namespace

double BeamSource::spot_depth_m(const Eigen::Vector3d& center, const Eigen::Vector3d& normal) const {
  const Eigen::Vector3d ray = center - origin;
  const double range = ray.norm(), diameter = beam.diameter_at(range);
  if (diameter == 0) return 0;
  return diameter * ray.cross(normal).norm() / std::abs(ray.dot(normal));
}

// Sorts the points into two staggered grids per resolution, in parallel, and makes surfels of each. What is kept and
// its order depend on the points only.
Features extract_features(std::span<const BodyPoint> points, const BeamSource& source, const PoseTrack& track,
                          const SurfelOptions& options, const PoleOptions& poles, int threads) {
  Features out;
  if (points.empty()) return out;
  std::vector<Eigen::Vector3d> world(points.size());
  for (std::size_t k = 0; k < points.size(); ++k)
    world[k] = track.pose(points[k].time_s) * points[k].position.cast<double>();
  const Eigen::Vector3d origin = track.pose(points.front().time_s).translation;
  const std::size_t levels = options.voxel_size_m.size(), keep = static_cast<std::size_t>(options.max_surfels_per_bin);
  std::vector<std::vector<Ranked>> found(2 * levels);
  std::vector<std::vector<Surfel>> upright(2 * levels);
  parallel_each(2 * levels, threads, [&](std::size_t k, int) {
    const std::size_t level = k / 2;
    const int stagger = static_cast<int>(k % 2);
    const VoxelMap map = fill_grid(world, points, origin, options.voxel_size_m[level], stagger);
    found[k] = surfels_of(map, origin, source, track, options, level, stagger);
    if (level == 0) upright[k] = detect_poles(map, options.voxel_size_m[0], origin, source.origin, track, poles);
  });
  for (std::size_t level = 0; level < levels; ++level) {
    std::vector<Ranked>& both = found[2 * level];
    both.insert(both.end(), found[2 * level + 1].begin(), found[2 * level + 1].end());
    if (both.size() > keep) {  // a fixed pseudo-random choice, even over space
      std::stable_sort(both.begin(), both.end(), [](const Ranked& a, const Ranked& b) { return a.first < b.first; });
      both.resize(keep);
    }
    for (const auto& [rank, surfel] : both) out.surfels.push_back(surfel);
    for (std::size_t k = 2 * level; k <= 2 * level + 1; ++k)
      out.poles.insert(out.poles.end(), upright[k].begin(), upright[k].end());
  }
  const auto earlier = [](const Surfel& a, const Surfel& b) { return a.time_s < b.time_s; };
  std::stable_sort(out.surfels.begin(), out.surfels.end(), earlier);
  std::stable_sort(out.poles.begin(), out.poles.end(), earlier);
  return out;
}

}  // namespace rayfield::slam
