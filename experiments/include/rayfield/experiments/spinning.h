#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/experiments/leaf_normals.h"
#include "rayfield/experiments/moments.h"

namespace rayfield::experiments {

/// The paper's "Comparison of Trawling and Spinning lidar in Simulation": leaves of which the normals prefer an axis,
/// in one voxel. Rays of a trawling (push-broom) lidar run along x, those of a spinning one horizontally, 0 to 70° from
/// x, each at an even angle of its own.
struct SpinningOptions {
  double voxel_m = 0.10;         ///< side of the voxel, 0.01–1
  double leaf_side_m = 0.06;     ///< of equilateral leaves, 0.001–1
  double leaf_area_m2 = 0.02;    ///< expected area in the voxel, 10⁻⁶–10
  int rays = 50;                 ///< 2–1000
  double widest_angle_deg = 70;  ///< of the spinning lidar's rays, 0–90
  std::uint64_t trials = 20000;  ///< per cell, 2 … 10⁷; the paper has 400
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all processors; changes no result

  Result<void> validate() const;
};

/// One lidar looking at one distribution of normals. Normalised errors of the estimate of leaf area.
struct SpinningCell {
  Mean debiased;  ///< (n − 1)/n·m/S: the paper's
  Mean unbiased;  ///< m/S − H/S²
  Mean infinitesimal;  ///< 2·⟨|n·d|⟩ − 1 over normals n and rays d: what leaves without size and many rays would give
};

struct SpinningRow {
  Eigen::Vector3d eccentricity = Eigen::Vector3d::Ones();
  double paper_trawling = 0, paper_spinning = 0;   ///< the paper's table, as shares
  std::array<SpinningCell, 2> trawling, spinning;  ///< by NormalBody
};

struct SpinningResult {
  std::vector<SpinningRow> rows;
};

/// A line of the paper's table "Percentage error between estimated and actual leaf area …".
struct SpinningFigure {
  std::array<double, 3> eccentricity;
  double trawling_percent, spinning_percent;
};
inline constexpr std::array<SpinningFigure, 4> kPaperSpinning{
    {{{10, 1, 1}, 67.9, 45.5}, {{1, 10, 1}, -44.6, -1.1}, {{1, 1, 10}, -68.5, -68.5}, {{1, 1, 1}, 3.7, 2.6}}};

inline constexpr double kPaperSpinningTrials = 400;

/// By how many standard errors of the difference the paper's figure, of so many trials, is off.
double paper_deviations(double paper, const Mean& simulated, std::uint64_t trials);

/// Errors: usage, interrupted.
Result<SpinningResult> run_spinning(const SpinningOptions& options, Progress& progress);

}  // namespace rayfield::experiments
