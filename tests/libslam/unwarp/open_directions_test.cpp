#include "libslam/unwarp/open_directions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rayfield::slam {
namespace {

TEST(OpenDirections, AreThoseFromWhichBeamsReturnNowAndThen) {
  const Eigen::Vector3d open = Eigen::Vector3d(1, 0.2, -0.3).normalized(),
                        shut = Eigen::Vector3d(-1, 0.2, -0.3).normalized();
  OpenDirections directions;
  for (int beam = 0; beam < 19; ++beam) directions.add(open, true);
  EXPECT_FALSE(directions.open(open)) << "too few beams to tell";
  directions.add(open, false);
  EXPECT_TRUE(directions.open(open));
  for (int beam = 0; beam < 1000; ++beam) directions.add(shut, beam % 100 == 0);
  EXPECT_FALSE(directions.open(shut));
}

TEST(OpenDirections, TellsDirectionsApartByAFewDegreesAllRound) {
  const double step = 0.1;
  for (double azimuth = -3; azimuth < 3; azimuth += step)
    for (double elevation = -1.5; elevation < 1.5; elevation += step) {
      const auto to = [](double a, double e) {
        return Eigen::Vector3d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      };
      OpenDirections directions;
      for (int beam = 0; beam < 20; ++beam) directions.add(to(azimuth, elevation), true);
      EXPECT_TRUE(directions.open(to(azimuth, elevation)));
      EXPECT_FALSE(directions.open(to(azimuth, elevation + step))) << azimuth << " " << elevation;
    }
}

}  // namespace
}  // namespace rayfield::slam
