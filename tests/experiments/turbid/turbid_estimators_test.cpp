#include "rayfield/experiments/turbid_estimators.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::experiments {
namespace {

double of(const TurbidBias& bias, TurbidEstimator estimator) { return bias[static_cast<std::size_t>(estimator)]; }

// Where at most one of n rays hits, anywhere in 0 … 1: E[m/S]/λ = n·∫dx/(n − 1 + x) = n·ln(n/(n − 1)).
TEST(TurbidBias, OfThinAirIsThatOfOneHitAtAnyDepth) {
  for (const int n : {2, 3, 10, 50}) {
    const TurbidBias bias = turbid_bias(n, 1e-4);
    const double ratio = n * std::log(n / (n - 1.0));
    EXPECT_NEAR(of(bias, TurbidEstimator::maximum_likelihood), ratio - 1, 1e-3) << n;
    EXPECT_NEAR(of(bias, TurbidEstimator::debiased), (n - 1.0) / n * ratio - 1, 1e-3) << n;
    EXPECT_NEAR(of(bias, TurbidEstimator::mode), -1, 0.01) << n;  // one hit in n·λ trials counts as none
  }
}

// Where no ray is censored S is a Gamma variable: E[n/S] = λ·n/(n − 1), and the paper's (n − 1)/S is unbiased.
TEST(TurbidBias, OfADenseMediumIsThatWithoutCensoring) {
  for (const int n : {2, 3, 10, 50}) {
    const TurbidBias bias = turbid_bias(n, 60);
    EXPECT_NEAR(of(bias, TurbidEstimator::maximum_likelihood), 1.0 / (n - 1), 1e-6) << n;
    EXPECT_NEAR(of(bias, TurbidEstimator::debiased), 0, 1e-6) << n;
    EXPECT_NEAR(of(bias, TurbidEstimator::mode), 0, 1e-6) << n;
  }
}

TEST(TurbidBias, OfTheUnbiasedEstimatorIsZeroAtAnyDepth) {
  for (const int n : {2, 5, 50})
    for (const double depth : {0.01, 0.3, 1.0, 10.0})
      EXPECT_NEAR(of(turbid_bias(n, depth), TurbidEstimator::unbiased), 0, 1e-6) << n << " " << depth;
}

// Every ray that hits counts 1/y whatever its depth: E = P(hit)/y = 1 − exp(−λ).
TEST(TurbidBias, OfHitsPerUnimpededDepthIsThatOfTheHitProbability) {
  EXPECT_NEAR(of(turbid_bias(7, 2), TurbidEstimator::naive), (1 - std::exp(-2.0)) / 2 - 1, 1e-12);
}

}  // namespace
}  // namespace rayfield::experiments
