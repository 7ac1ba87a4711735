#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "rayfield/core/ray.h"
#include "rayfield/core/result.h"
#include "rayfield/sim/site.h"

/// leaf_box: a canopy of which everything is known: nothing but leaves, at random in a box. An estimator's errors there
/// do not come from ground, wood or clumping.
namespace rayfield::sim {

struct LeafBoxOptions {
  Eigen::Vector3d size_m = {3, 0.6, 1.2};  ///< of the box from the origin on, 0.01–100 each
  double density_m2_m3 = 3;                ///< one-sided leaf area per volume, 0–100
  double leaf_size_m2 = 0.006;             ///< one-sided, of one leaf, 10⁻⁵–1
  std::uint64_t seed = 1;                  ///< of the leaves

  Result<void> validate() const;
};

/// A pulse of the lidar.
struct Pulse {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(), direction = Eigen::Vector3d::UnitX();  ///< m; unit vector
  double time_s = 0;
};

/// Leaves whose middles lie evenly in the box, with normals in all directions alike; their rims reach out of it by up
/// to half of the longer diagonal (0.74 of the root of a leaf's area).
class LeafBox {
 public:
  /// Errors: usage (options), resources (memory).
  static Result<LeafBox> create(const LeafBoxOptions& options);

  std::size_t leaf_count() const;
  double leaf_area_m2() const;  ///< one-sided, of all leaves

  /// The rays that a lidar makes of pulses: thin lines, or beams of which the share that falls on leaves makes the echo
  /// (docs/simulation.md, "Beams"). No range noise, no dropouts, and intensities that do not fall with range. What
  /// meets nothing, or too little, ends at the lidar's max_range_m without a hit. Uses of `lidar` what a beam is made
  /// of. `seed`: of how sub-rays are turned and of what is added to the threshold.
  RayBatch scan(std::span<const Pulse> pulses, const SiteLidar& lidar, std::uint64_t seed) const;

 private:
  struct Impl;
  explicit LeafBox(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<const Impl> impl_;
};

/// Mean intensity of the echo of such leaves when they take the whole beam: hits prefer leaves that face the lidar, and
/// the mean cosine to the normal is 2/3 where all directions are alike.
double full_echo_of_random_leaves();

}  // namespace rayfield::sim
