#pragma once

#include <array>
#include <cstddef>

namespace rayfield::experiments {

/// Estimators of λ from m hits among n rays, S = Σx over all of them, H = Σx over the hits.
enum class TurbidEstimator {
  naive,               ///< m/Σy: hits per depth as if no ray had ended early
  maximum_likelihood,  ///< m/S, eq. (leafdensity)
  mode,                ///< max(m − 1, 0)/S, eq. (BayesEstimates)
  debiased,            ///< (n − 1)/n·m/S, eqs. (factored), (debias_func): density::estimate_paper
  unbiased,            ///< m/S − H/S²: density::unbiased_rate
};
inline constexpr std::size_t kTurbidEstimators = 5;
const char* name_of(TurbidEstimator estimator);

/// Normalised bias (E[λ̂] − λ)/λ of every estimator.
using TurbidBias = std::array<double, kTurbidEstimators>;

/// The exact biases for y = 1, by numerical integration; n ≥ 2. With k = λ + s and, over one ray,
///   a(s) = E[1{hit}·e^(−sx)] = λ/k·(1 − e^(−k)),  b(s) = E[e^(−sx)] = a(s) + e^(−k),
///   c(s) = E[1{hit}·x·e^(−sx)] = λ/k²·(1 − e^(−k)·(1 + k)),
/// 1/S = ∫e^(−sS)ds and 1/S² = ∫s·e^(−sS)ds give
///   E[m/S] = n·∫a·bⁿ⁻¹ds,  E[H/S²] = n·∫s·c·bⁿ⁻¹ds,  E[1{m > 0}/S] = ∫(bⁿ − e^(−nk))ds.
TurbidBias turbid_bias(int rays, double optical_depth);

}  // namespace rayfield::experiments
