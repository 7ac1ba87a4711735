#include "rayfield/experiments/turbid_estimators.h"

#include <cmath>

namespace rayfield::experiments {
namespace {

constexpr int kSteps = 20000;

/// E[m/S], E[H/S²] and E[1{m > 0}/S].
struct Expected {
  double hits_over_path = 0, hit_path_over_square = 0, any_over_path = 0;
};

/// Midpoint rule in u = s/(s + scale), which takes s = 0 … ∞ to 0 … 1: the integrands fall as s^(−n), n ≥ 2, so that
/// they stay finite at u = 1.
Expected integrate(int rays, double lambda) {
  const double n = rays, scale = 1 + lambda;
  Expected sum;
  for (int i = 0; i < kSteps; ++i) {
    const double u = (i + 0.5) / kSteps, s = scale * u / (1 - u), ds = scale / ((1 - u) * (1 - u)) / kSteps;
    const double k = lambda + s, passed = std::exp(-k);
    const double a = lambda / k * (1 - passed), b = a + passed;
    const double c = lambda / (k * k) * (1 - passed * (1 + k));
    const double others = std::pow(b, n - 1);
    sum.hits_over_path += n * a * others * ds;
    sum.hit_path_over_square += n * s * c * others * ds;
    sum.any_over_path += (b * others - std::pow(passed, n)) * ds;
  }
  return sum;
}

}  // namespace

const char* name_of(TurbidEstimator estimator) {
  switch (estimator) {
    case TurbidEstimator::naive:
      return "naive";
    case TurbidEstimator::maximum_likelihood:
      return "maximum_likelihood";
    case TurbidEstimator::mode:
      return "mode";
    case TurbidEstimator::debiased:
      return "debiased";
    case TurbidEstimator::unbiased:
      return "unbiased";
  }
  return "";
}

TurbidBias turbid_bias(int rays, double optical_depth) {
  const double lambda = optical_depth;
  const Expected e = integrate(rays, lambda);
  TurbidBias bias;
  const auto set = [&](TurbidEstimator estimator, double expected) {
    bias[static_cast<std::size_t>(estimator)] = expected / lambda - 1;
  };
  set(TurbidEstimator::naive, 1 - std::exp(-lambda));
  set(TurbidEstimator::maximum_likelihood, e.hits_over_path);
  set(TurbidEstimator::mode, e.hits_over_path - e.any_over_path);
  set(TurbidEstimator::debiased, (rays - 1.0) / rays * e.hits_over_path);
  set(TurbidEstimator::unbiased, e.hits_over_path - e.hit_path_over_square);
  return bias;
}

}  // namespace rayfield::experiments
