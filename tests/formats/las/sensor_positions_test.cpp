#include "formats/las/sensor_positions.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace rayfield::formats {
namespace {

constexpr double kTurn = std::numbers::pi / 2;

// Along east at 1 m/s, turning left by 90° from t = 1 to t = 2; a gap from t = 2 to t = 5.
std::shared_ptr<const TrajectoryFile> drive() {
  const auto pose = [](double t, double east, double yaw) {
    return TimedPose{t, {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), {east, 10, 2}}};
  };
  auto trajectory = std::make_shared<TrajectoryFile>();
  trajectory->poses = {pose(0, 0, 0), pose(1, 1, 0), pose(2, 2, kTurn), pose(5, 5, kTurn), pose(6, 6, kTurn)};
  return trajectory;
}

TEST(SensorPositions, IsLinearBetweenPoses) {
  SensorPositions track(drive(), Eigen::Vector3d::Zero(), 1.1, 0.01);
  Eigen::Vector3d p;
  for (const double t : {0.0, 0.25, 1.0, 1.75, 2.0, 5.5, 6.0, 0.5}) {  // also backwards
    ASSERT_EQ(track.at(t, p), SensorPositions::Place::found) << t;
    EXPECT_LT((p - Eigen::Vector3d(t, 10, 2)).norm(), 1e-12) << t;
  }
}

TEST(SensorPositions, TurnsTheLeverArmWithTheBody) {
  const Eigen::Vector3d arm(1, 0, 0.5);
  SensorPositions track(drive(), arm, 1.1, 0.01);
  Eigen::Vector3d p;
  ASSERT_EQ(track.at(0.5, p), SensorPositions::Place::found);
  EXPECT_LT((p - Eigen::Vector3d(0.5 + 1, 10, 2.5)).norm(), 1e-12);
  ASSERT_EQ(track.at(1.5, p), SensorPositions::Place::found);  // half of the turn
  const double half = std::numbers::sqrt2 / 2;
  EXPECT_LT((p - Eigen::Vector3d(1.5 + half, 10 + half, 2.5)).norm(), 1e-12);
  ASSERT_EQ(track.at(6, p), SensorPositions::Place::found);
  EXPECT_LT((p - Eigen::Vector3d(6, 11, 2.5)).norm(), 1e-12);
}

TEST(SensorPositions, EndsAtItsPosesAndAtGaps) {
  SensorPositions track(drive(), Eigen::Vector3d::Zero(), 1.1, 0.01);
  Eigen::Vector3d p;
  EXPECT_EQ(track.at(-0.02, p), SensorPositions::Place::outside);
  EXPECT_EQ(track.at(6.02, p), SensorPositions::Place::outside);
  EXPECT_EQ(track.at(std::numeric_limits<double>::quiet_NaN(), p), SensorPositions::Place::outside);
  EXPECT_EQ(track.at(3, p), SensorPositions::Place::gap);
  ASSERT_EQ(track.at(-0.005, p), SensorPositions::Place::found);
  EXPECT_EQ(p, Eigen::Vector3d(0, 10, 2));
  ASSERT_EQ(track.at(6.005, p), SensorPositions::Place::found);
  EXPECT_EQ(p, Eigen::Vector3d(6, 10, 2));
  ASSERT_EQ(track.at(2.005, p), SensorPositions::Place::found);
  EXPECT_EQ(p, Eigen::Vector3d(2, 10, 2));
  ASSERT_EQ(track.at(4.995, p), SensorPositions::Place::found);
  EXPECT_EQ(p, Eigen::Vector3d(5, 10, 2));
  SensorPositions patient(drive(), Eigen::Vector3d::Zero(), 3, 0.01);
  ASSERT_EQ(patient.at(3, p), SensorPositions::Place::found);
  EXPECT_LT((p - Eigen::Vector3d(3, 10, 2)).norm(), 1e-12);
}

TEST(SensorPositions, OfOnePoseIsAPlace) {
  auto single = std::make_shared<TrajectoryFile>();
  single->poses = {{100, {Eigen::Quaterniond::Identity(), {1, 2, 3}}}};
  SensorPositions track(single, Eigen::Vector3d::Zero(), 1.1, 0.01);
  Eigen::Vector3d p;
  ASSERT_EQ(track.at(100.005, p), SensorPositions::Place::found);
  EXPECT_EQ(p, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(track.at(101, p), SensorPositions::Place::outside);
}

}  // namespace
}  // namespace rayfield::formats
