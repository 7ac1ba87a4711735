#include "libdensity/ground/sensor_track.h"

#include <gtest/gtest.h>

namespace rayfield::density {
namespace {

using Eigen::Vector3d;

const SensorTrack kTrack({{10.0, {0, 0, 1}}, {10.1, {0.1, 0, 1}}, {10.2, {0.2, 0.1, 1}}, {40.0, {5, 5, 1}}});

TEST(SensorTrack, RunsStraightBetweenItsPoints) {
  std::size_t hint = 0;
  EXPECT_TRUE(kTrack.position(10.05, hint).isApprox(Vector3d(0.05, 0, 1), 1e-9));
  EXPECT_TRUE(kTrack.position(10.15, hint).isApprox(Vector3d(0.15, 0.05, 1), 1e-9));
  EXPECT_TRUE(kTrack.position(10.1, hint).isApprox(Vector3d(0.1, 0, 1), 1e-9));
}

TEST(SensorTrack, GoesOnBeyondItsEndsByOneStepAtMost) {
  std::size_t hint = 0;
  EXPECT_TRUE(kTrack.position(9.95, hint).isApprox(Vector3d(-0.05, 0, 1), 1e-9));
  EXPECT_TRUE(kTrack.position(0, hint).isApprox(Vector3d(-0.1, 0, 1), 1e-9));
  const SensorTrack two({{1, {0, 0, 0}}, {2, {1, 0, 0}}});
  EXPECT_TRUE(two.position(2.5, hint).isApprox(Vector3d(1.5, 0, 0), 1e-9));
  EXPECT_TRUE(two.position(99, hint).isApprox(Vector3d(2, 0, 0), 1e-9));
}

TEST(SensorTrack, TheHintChangesNothing) {
  for (const double time : {9.0, 10.0, 10.12, 10.2, 25.0, 40.0, 50.0})
    for (std::size_t start = 0; start < 9; ++start) {
      std::size_t zero = 0, hint = start;
      EXPECT_EQ(kTrack.position(time, hint), kTrack.position(time, zero)) << time << " " << start;
    }
}

TEST(SensorTrack, OneOrNoPointIsAPlaceToo) {
  std::size_t hint = 3;
  EXPECT_EQ(SensorTrack({{1, {2, 3, 4}}}).position(7, hint), Vector3d(2, 3, 4));
  EXPECT_TRUE(SensorTrack().empty());
  EXPECT_EQ(SensorTrack().position(7, hint), Vector3d(0, 0, 0));
}

}  // namespace
}  // namespace rayfield::density
