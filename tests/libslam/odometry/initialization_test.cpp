#include "libslam/odometry/initialization.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rayfield::slam {
namespace {

TEST(WhiteNoise, IsMeasuredThroughTheBounceOfTheVehicle) {
  std::mt19937 generator(9);
  std::normal_distribution<double> gauss(0, 1);
  ImuGrid grid(0, 0.01);
  for (int k = 0; k < 1000; ++k) {
    ImuSample s;
    s.time_s = 0.01 * k;
    for (int axis = 0; axis < 3; ++axis) {
      s.angular_velocity_rad_s[axis] = 0.1 * std::sin(6.3 * 3 * s.time_s) + 0.003 * gauss(generator);
      s.linear_acceleration_m_s2[axis] = 2.7 * std::sin(6.3 * 3.1 * s.time_s) + 0.09 * gauss(generator);
    }
    grid.add(s);
  }
  const WhiteNoise noise = measure_white_noise(grid);
  EXPECT_NEAR(noise.gyro_density, 3e-4, 0.3e-4);  // 0.003 rad/s per sample at 100 Hz
  EXPECT_NEAR(noise.accel_density, 9e-3, 0.9e-3);
}

}  // namespace
}  // namespace rayfield::slam
