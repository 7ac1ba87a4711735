#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <random>
#include <vector>

#include "libdensity/voxels/voxel_accumulator.h"

/// Small voxel grids and rays through them, for tests.
namespace rayfield::density::testing {

/// A tile that holds everything near (250, 500).
inline constexpr tile::TileIndex kBigTile{0, 0};
inline constexpr double kBigTileSize = 1000;

/// 20 × 10 × 12 voxels of 12 cm on sloping ground, turned by 30°, across the corner of tiles of 25 m at (250, 500).
inline RowSegment make_row_segment() {
  RowSegment s;
  s.row = 1;
  s.direction = {std::cos(0.5), std::sin(0.5)};
  s.origin = Eigen::Vector2d(250, 500) - 1.2 * s.direction;
  s.ground_m = 30, s.slope_along = 0.06, s.slope_across = -0.03;
  s.n_along = 20, s.n_across = 10, s.n_up = 12;
  s.across_min_m = -0.6, s.voxel_m = 0.12;
  return s;
}

/// By the definition in row_layout.h, independently of the library's own transform.
inline Eigen::Vector3d map_from_grid(const RowSegment& s, const Eigen::Vector3d& g) {
  const double along = g.x() * s.voxel_m, across = s.across_min_m + g.y() * s.voxel_m;
  const Eigen::Vector2d p =
      s.origin + along * s.direction + across * Eigen::Vector2d(-s.direction.y(), s.direction.x());
  return {p.x(), p.y(), s.ground_m + s.slope_along * along + s.slope_across * across + s.up_min_m + g.z() * s.voxel_m};
}

inline Eigen::Vector3d grid_from_map(const RowSegment& s, const Eigen::Vector3d& p) {
  const Eigen::Vector2d d = p.head<2>() - s.origin;
  const double along = d.dot(s.direction), across = -d.x() * s.direction.y() + d.y() * s.direction.x();
  const double up = p.z() - s.ground_m - s.slope_along * along - s.slope_across * across;
  return Eigen::Vector3d(along, across - s.across_min_m, up - s.up_min_m) / s.voxel_m;
}

/// Path of a ray through one voxel by clipping it against the voxel's six faces in the row's frame: no traversal.
inline double clipped_path(const RowSegment& s, int a, int c, int u, const Eigen::Vector3d& p,
                           const Eigen::Vector3d& q) {
  const auto local = [&](const Eigen::Vector3d& x) {
    const Eigen::Vector2d d = x.head<2>() - s.origin;
    const double along = d.dot(s.direction), across = -d.x() * s.direction.y() + d.y() * s.direction.x();
    return Eigen::Vector3d(along, across, x.z() - s.ground_m - s.slope_along * along - s.slope_across * across);
  };
  const Eigen::Vector3d a0 = local(p), d = local(q) - a0;
  const Eigen::Vector3d low(a * s.voxel_m, s.across_min_m + c * s.voxel_m, s.up_min_m + u * s.voxel_m);
  double in = 0, out = 1;
  for (int k = 0; k < 3; ++k) {
    const double f = (low[k] - a0[k]) / d[k], g = (low[k] + s.voxel_m - a0[k]) / d[k];
    in = std::max(in, std::min(f, g)), out = std::min(out, std::max(f, g));
  }
  return std::max(0.0, out - in) * (q - p).norm();
}

inline void push_ray(tile::SegmentBatch& rays, const Eigen::Vector3d& from, const Eigen::Vector3d& to, bool hit) {
  rays.entry.push_back(from), rays.exit.push_back(to);
  rays.time_s.push_back(0), rays.intensity.push_back(0);
  rays.flags.push_back(static_cast<std::uint8_t>(tile::kStartsHere | tile::kEndsHere | (hit ? tile::kHit : 0)));
}

inline void copy_ray(const tile::SegmentBatch& from, std::size_t i, tile::SegmentBatch& to) {
  to.entry.push_back(from.entry[i]), to.exit.push_back(from.exit[i]);
  to.time_s.push_back(from.time_s[i]), to.intensity.push_back(from.intensity[i]), to.flags.push_back(from.flags[i]);
}

/// Rays between random points in a box half again as large as the grid; two thirds of them end on something.
inline tile::SegmentBatch random_rays(const RowSegment& s, int count, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> uniform(-0.25, 1.25);
  const auto point = [&] {
    return map_from_grid(s, {uniform(rng) * s.n_along, uniform(rng) * s.n_across, uniform(rng) * s.n_up});
  };
  tile::SegmentBatch rays;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d from = point();
    push_ray(rays, from, point(), i % 3 != 0);
  }
  return rays;
}

/// Rays between random points are no scan: none of them is left out.
inline VoxelOptions count_every_ray() {
  VoxelOptions options;
  options.sure_return_m = 0;
  return options;
}

inline TileVoxels count_all(const std::vector<RowSegment>& row_segments, const tile::SegmentBatch& rays,
                            const std::vector<WoodCylinder>& wood = {},
                            std::shared_ptr<const BeamView> view = nullptr) {
  auto accumulator = VoxelAccumulator::create({kBigTile, kBigTileSize}, row_segments, wood, count_every_ray(), view);
  if (!accumulator || !accumulator->add(rays)) return {};
  return std::move(*accumulator).finish();
}

}  // namespace rayfield::density::testing
