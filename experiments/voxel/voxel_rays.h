#pragma once

#include <Eigen/Core>
#include <span>

#include "experiments/voxel/leaf_triangles.h"
#include "rayfield/sim/random.h"

namespace rayfield::experiments {

/// The path of a line through the voxel: y of the paper is its length.
struct Chord {
  Eigen::Vector3d entry, direction;  ///< m; unit vector
  double length_m = 0;
};

/// A line of a given direction that goes evenly over the voxel's shadow in that direction.
Chord draw_parallel_chord(const Eigen::Vector3d& direction, double voxel_m, sim::CounterRandom& random);

/// A line of any direction and place, uniform as lines in space are (a direction is as frequent as the voxel's shadow
/// in it is large). Their mean length is 4·volume/surface = 2/3·w (Cauchy).
Chord draw_chord(double voxel_m, sim::CounterRandom& random);

/// What the rays of a trial have counted in the voxel.
struct VoxelCounts {
  std::uint64_t rays = 0, hits = 0;  ///< n, m
  double path_m = 0;                 ///< S = Σx
  double hit_path_m = 0;             ///< H = Σx over the hits

  /// Sends one ray: it ends at its first leaf.
  void send(const Chord& chord, std::span<const Triangle> leaves);
};

/// Densities g·λ̂ of the paper, g = 2, m²/m³.
struct VoxelDensities {
  double maximum_likelihood = 0;  ///< g·m/S
  double debiased = 0;            ///< density::estimate_paper
  double unbiased = 0;            ///< g·density::unbiased_rate
};
VoxelDensities densities_of(const VoxelCounts& counts);

/// Leaf area in the voxel over its volume, m²/m³.
double true_density(std::span<const Triangle> leaves, double voxel_m);

}  // namespace rayfield::experiments
