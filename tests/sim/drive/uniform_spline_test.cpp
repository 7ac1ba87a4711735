#include "sim/drive/uniform_spline.h"

#include <gtest/gtest.h>

namespace rayfield::sim {
namespace {

TEST(UniformSpline, ReproducesStraightLines) {
  std::vector<Eigen::Matrix<double, 1, 1>> control;
  for (int i = -2; i < 12; ++i) control.emplace_back(3.0 + 0.5 * i);
  const UniformSpline<1> spline(0, 0.25, control);
  for (double t = 0; t <= spline.end(); t += 0.01) {
    const auto at = spline.evaluate(t);
    EXPECT_NEAR(at.value[0], 3 + 2 * t, 1e-12);
    EXPECT_NEAR(spline.value(t)[0], 3 + 2 * t, 1e-12);
    EXPECT_NEAR(at.first[0], 2, 1e-12);
    EXPECT_NEAR(at.second[0], 0, 1e-10);
  }
}

}  // namespace
}  // namespace rayfield::sim
