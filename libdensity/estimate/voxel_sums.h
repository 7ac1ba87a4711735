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
  double hits = 0;
  double hits_squared = 0;  ///< Σ of the squares of what hits count: the variance of `hits`
  double path = 0, hit_path = 0, potential = 0;
};

std::vector<VoxelSums> thin_ray_sums(std::span<const VoxelCounters> counters);

/// One across a row; the voxels of one follow those of the one before along the row.
struct CrossSection {
  std::size_t voxels = 0;
  double voxel_m = 0;  ///< side
};

/// Of wide beams. With E the full echo, s the share of a beam that its echo holds (intensity over E), R the
/// ReturnedShare of the voxel's mean beam width, of the optical path before it, and of that of a range resolution
/// around the row's echoes:
///   hits = Σ s,  path = R·(Σ u + Σ (1 − s)·u behind the echoes).
/// The optical path before is the row's mean density times the path. Around echoes the density is that of their place
/// in the row's cross section, in the mean along the row (single leaves would count themselves otherwise), unless the
/// model says its optical path. Both come from the round before: three rounds.
std::vector<VoxelSums> wide_beam_sums(std::span<const VoxelCounters> counters, std::span<const EchoCounters> echoes,
                                      const CrossSection& section, const EchoModel& model);

}  // namespace rayfield::density
