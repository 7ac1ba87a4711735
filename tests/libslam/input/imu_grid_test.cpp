#include "libslam/input/imu_grid.h"

#include <gtest/gtest.h>

namespace rayfield::slam {
namespace {

ImuSample linear_sample(double t) {
  ImuSample s;
  s.time_s = 50 + t;
  s.angular_velocity_rad_s = Eigen::Vector3d(t, 2 * t, -t);
  s.linear_acceleration_m_s2 = Eigen::Vector3d(1 - t, 0, 9.8);
  return s;
}

TEST(ImuGrid, InterpolatesSlowSensorsAndAveragesFastOnes) {
  for (const double rate : {40.0, 100.0, 130.0, 1000.0}) {
    ImuGrid grid(50, 0.01);
    for (int k = 0; k <= static_cast<int>(2 * rate); ++k) grid.add(linear_sample(k / rate));
    ASSERT_GT(grid.size(), 190) << rate;
    // A linear signal: interpolation is exact; the mean over a cell is off by at most half a sample; and a sample that
    // stands alone in its cell off the grid time by at most half a cell.
    for (int k = 1; k < grid.size(); ++k) EXPECT_NEAR(grid.gyro()[k].x(), 0.01 * k, 0.0051) << rate;
    if (rate == 100.0) {
      EXPECT_NEAR(grid.gyro()[77].y(), 1.54, 1e-9);
    }
  }
}

}  // namespace
}  // namespace rayfield::slam
