#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <random>

#include "libdensity/estimate/row_density.h"
#include "tests/libdensity/voxel_worlds.h"

namespace rayfield::density::testing {

/// A row of two row segments with a bend of 3°, random densities, everything observed.
inline RowDensity random_row(std::uint64_t seed) {
  RowDensity r;
  r.row = 1;
  RowSegment a = make_row_segment(), b = a;
  a.chainage_m = 0;
  b.index = 1, b.first_along = a.n_along, b.chainage_m = a.n_along * a.voxel_m;
  b.origin = a.origin + b.chainage_m * a.direction;
  b.direction = Eigen::Rotation2Dd(0.05) * a.direction;
  r.row_segments = {a, b};
  r.voxel_m = a.voxel_m, r.n_across = a.n_across, r.n_up = a.n_up;
  r.across_min_m = a.across_min_m, r.up_min_m = a.up_min_m;
  for (int s = 0; s < 2; ++s)
    for (int i = 0; i < a.n_along; ++i) {
      r.segment_of.push_back(s);
      r.chainage_m.push_back((s * a.n_along + i) * a.voxel_m);
    }
  r.n_along = 2 * a.n_along;
  const auto voxels = static_cast<std::size_t>(r.n_along * r.n_across * r.n_up);
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<float> uniform(0, 8);
  for (std::size_t i = 0; i < voxels; ++i) r.density.push_back(uniform(rng)), r.variance.push_back(uniform(rng));
  r.state.assign(voxels, VoxelState::observed);
  r.entries.assign(r.segment_of.size(), 3);
  return r;
}

}  // namespace rayfield::density::testing
