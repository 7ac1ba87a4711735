#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libdensity/echoes/echo_model.h"
#include "libdensity/voxels/voxel_grid.h"

namespace rayfield::density {

/// Sums over the rays of a voxel that the estimate is made of; paths in voxel sides, spherical-equivalent. Of thin rays
/// they are VoxelCounters; of wide beams what thin rays in their place would have counted, in the mean.
struct VoxelSums {
  std::uint32_t rays = 0;
  std::uint32_t ends = 0;  ///< rays that end inside, whatever their echoes hold
  double hits = 0;
  double hits_squared = 0;  ///< Σ of the squares of what hits count: the variance of `hits`
  double path = 0, hit_path = 0, potential = 0;
};

std::vector<VoxelSums> thin_ray_sums(std::span<const VoxelCounters> counters);

/// One across a row; the voxels of one, upwards first, follow those of the one before along the row.
struct CrossSection {
  std::size_t n_across = 0, n_up = 0;
  double voxel_m = 0;  ///< side
  std::size_t voxels() const { return n_across * n_up; }
};

/// Of wide beams. With E the full echo, s the share of a beam that its echo holds (intensity over E), D the mean width
/// of the voxel's beams over the side of a leaf, ℓ the lost and υ the unreturned share, b the range resolution; T the
/// optical path of a ray right across the row and n that of a range resolution, both as the row is within 1.5 m along
/// it; q the brightness of wood beside that of leaves and W half its surface per area of the canopy's side:
///   hits = Σ s/(1 − p·(1 − q)),  p = min(0.8, 0.5·W/T),  path = R·(Σ u + Σ (1 − s)·u behind the echoes),
///   −ln R = 1.2·υ·T·exp(−max(0, b − 0.17 m)/0.25 m) + 0.26·min(0.2, ℓ·T) + ℓ·min(1, 0.45/T) + 0.10·D·(1 − 1.5·n)
/// and, of lidars that report the strongest or the last of several echoes,
///   1.1·√(D·T)·max(0, 0.5 − t)·exp(−b/0.25 m) or 11·√(D·T)·max(0, 0.5 − t)²·exp(−b/0.25 m) more
/// (docs/beams.md, "How it is taken out"). T and n come from the round before: three rounds.
std::vector<VoxelSums> wide_beam_sums(std::span<const VoxelCounters> counters, std::span<const EchoCounters> echoes,
                                      const CrossSection& section, const EchoModel& model);

}  // namespace rayfield::density
