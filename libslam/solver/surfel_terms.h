#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>

#include "libslam/solver/block_system.h"
#include "libslam/solver/residuals.h"
#include "libslam/surfels/surfel_match.h"

namespace rayfield::slam {

/// Sums over the surfel residuals of one iteration.
struct SurfelSums {
  std::size_t matches = 0, inliers = 0;                   ///< inliers: within three standard deviations
  double weights = 0, squares = 0;                        ///< of the robust weights, of weighted squared offsets (m²)
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< on a shift of one side, independent matches, 1/m²
  double rms_m() const { return weights > 0 ? std::sqrt(squares / weights) : 0; }
  void add(const SurfelSums& other);
};

/// How surfel residuals are weighted.
struct SurfelWeights {
  double sigma_m = 0.005;  ///< standard deviation of an offset apart from the surfels' own thickness
  double cauchy = 1;       ///< Cauchy scale in standard deviations
  /// Additional standard deviation while lanes are still apart: the weight is 1/(variance + slack²), and the Cauchy
  /// scale √(cauchy²·variance + slack²). Whole lanes can then move by more than the thickness of their surfels, and
  /// wrong matches do not outweigh the IMU in the meantime.
  double slack_m = 0;
  /// Share of the variance of the surfels' layers that counts: their centres are known better than that.
  double layer_share = 1;
  /// Factor on all weights: how many independent ones a match counts for.
  double share = 1;
};
/// Surfels of overlapping voxels and resolutions share points, so that uncertainties count a match as a fifth. The
/// solution counts it whole, which gives smaller errors (docs/slam.md, "Stage a: windows").
inline constexpr double kIndependentShare = 0.2;

/// Adds the robustly weighted surfel residuals of `matches` to `system`.
/// What ties the two surfels of a match goes to `coupling`, which may be `system` itself.
SurfelSums add_surfel_terms(const ResidualFrame& frame, std::span<const Surfel> surfels,
                            std::span<const SurfelMatch> matches, const SurfelWeights& weights, BlockSystem& system,
                            BlockSystem& coupling);

}  // namespace rayfield::slam
