#pragma once

#include <cstdint>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/experiments/moments.h"

namespace rayfield::experiments {

/// What the width of beams does to leaf areas, and what of it the correction takes out (docs/beams.md): a wall of
/// random leaves, seen from both sides as from a drive along it, through counting and estimating as `process` has them.
struct BeamExperimentOptions {
  std::vector<double> diameters_m = {0.01, 0.02, 0.035, 0.05};  ///< of the beam at `distance_m`, 0.001–0.2
  std::vector<double> leaf_sizes_m2 = {0.004, 0.010};           ///< one-sided, of one leaf, 0.0005–0.05
  std::vector<double> detection_shares = {0.15, 0.25, 0.40};    ///< 0.01–0.9
  std::vector<double> densities_m2_m3 = {3, 8};  ///< one-sided leaf area per volume of the wall, 0.1–20
  /// Of the diameter at `distance_m`, what the beam has where it leaves the lidar, 0–1; the rest is divergence. 1: as
  /// wide everywhere. That of a SICK LMS511 at 2 m (13.6 mm + 11.9 mrad).
  double exit_share = 0.36;
  double thickness_m = 0.6;          ///< of the wall, 0.1–5
  double length_m = 3;               ///< 1–50
  double height_m = 1.2;             ///< 0.3–10
  double distance_m = 2;             ///< of the lidar from the middle of the wall, more than its half thickness … 20
  double range_resolution_m = 0.15;  ///< 0.005–2
  int fans = 700;                    ///< upright fans of beams per trial, half of them from each side, 2–10⁵
  std::uint64_t trials = 4;          ///< walls per cell, 2–10⁴
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all processors; changes no result

  Result<void> validate() const;
};

/// Errors are estimated over true leaf area, less 1.
struct BeamCell {
  double density_m2_m3 = 0, leaf_size_m2 = 0, detection_share = 0, diameter_m = 0;
  double voxel_m = 0;  ///< fitted to the leaves, as `process` does
  Mean counted;        ///< every echo as the hit of a thin ray
  Mean known;          ///< corrected, with the true full echo, detection share and leaf size given
  Mean measured;       ///< corrected with what the echoes show, as `process` does by default
  Mean full_echo, found_share, found_leaf_size;  ///< estimated from the echoes, over the true value
  /// Trials with too few echoes for the correction, which `process` then does without. They are
  /// in `counted` alone; where that are all trials the other means are 0.
  std::uint64_t not_told = 0;
};

/// Thin rays through the same walls: what the estimator does without a beam's width.
struct ThinReference {
  double density_m2_m3 = 0, leaf_size_m2 = 0, voxel_m = 0;
  Mean known;     ///< with the true leaf size given
  Mean measured;  ///< with the leaf size estimated from the rays
};

struct BeamResult {
  std::vector<ThinReference> thin;  ///< by density, then by leaf size
  std::vector<BeamCell> cells;      ///< by density, leaf size, detection share, diameter
};

/// Errors: usage, resources (memory), interrupted.
Result<BeamResult> run_beam(const BeamExperimentOptions& options, Progress& progress);

}  // namespace rayfield::experiments
