#pragma once
/// turbid: leaves without size in a voxel, and the estimators that are tried on them.
#include <array>
#include <cstdint>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/experiments/moments.h"
#include "rayfield/experiments/turbid_estimators.h"

namespace rayfield::experiments {

/// The paper's "Simulation of Turbid Medium in 1D": n rays cross a voxel of depth y = 1 in which a leaf stands in the
/// way with rate λ per depth. A ray ends at its first leaf or, censored, at the far side.
struct TurbidOptions {
  std::vector<int> rays = {2, 3, 5, 10, 20, 50};              ///< n, 2 … 1000
  std::vector<double> optical_depths = {0.1, 0.3, 1, 3, 10};  ///< λ·y, 0.001 … 100
  std::uint64_t trials = 1'000'000;                           ///< per cell, 2 … 10⁹; the paper's number
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all processors; changes no result

  Result<void> validate() const;
};

struct TurbidCell {
  int rays = 0;
  double optical_depth = 0;
  double censored_share = 0;                        ///< of rays that leave the voxel: exp(−λy)
  std::array<Mean, kTurbidEstimators> simulated{};  ///< normalised error, mean over trials
  TurbidBias exact{};                               ///< by turbid_bias()
};

/// Voxels without a far side (y = ∞): m = n, every ray ends on a leaf.
struct UncensoredCell {
  int rays = 0;
  Mean maximum_likelihood, debiased;  ///< normalised errors
  double debiased_deviation = 0;      ///< standard deviation of λ̂/λ
  double exact_deviation = 0;         ///< 1/√(n − 2), below eq. (uncensored); infinite for n = 2
};

struct TurbidResult {
  std::vector<TurbidCell> cells;  ///< by number of rays, then by depth
  std::vector<UncensoredCell> uncensored;
};

/// Standard errors of the mean are trustworthy from n = 3 on: with two rays the variance of the last three estimators
/// is not finite. Errors: usage, interrupted.
Result<TurbidResult> run_turbid(const TurbidOptions& options, Progress& progress);

}  // namespace rayfield::experiments
