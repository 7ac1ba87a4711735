#include "libslam/trajectory/correction_spline.h"

#include <gtest/gtest.h>

namespace rayfield::slam {
namespace {

TEST(CorrectionSpline, ReproducesAQuadratic) {
  // Cubic B-splines contain quadratics: knots c_j of t² are ((j−1)h)² − h²/3.
  const CorrectionSpline spline{2.0, 0.25, 8};
  for (double t = 2.0; t <= 4.0; t += 0.031) {
    const SplineWeights w = spline.weights(t);
    double value = 0, sum = 0;
    for (int j = 0; j < 4; ++j) {
      const double knot = (w.first + j - 1) * 0.25;
      const double c = knot * knot - 0.25 * 0.25 / 3;
      value += w.value[j] * c, sum += w.value[j];
    }
    EXPECT_NEAR(value, (t - 2) * (t - 2), 1e-12);
    EXPECT_NEAR(sum, 1, 1e-14);
  }
}

}  // namespace
}  // namespace rayfield::slam
