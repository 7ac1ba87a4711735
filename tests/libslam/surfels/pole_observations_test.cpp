#include "libslam/surfels/pole_observations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/libslam/pole_row.h"

namespace rayfield::slam {
namespace {

using testing::drive_along;
using testing::Row;

std::vector<PolePair> pairs_of(const Row& row, const std::vector<PoleObservation>& observations, double depth_m) {
  return pair_observations(observations, row.track, depth_m, {.reach_m = 0.15}, PoleOptions());
}

Eigen::Vector2d axis_of(const PoleObservation& v, const PoseTrack& track, double depth_m) {
  return (track.pose(v.time_s) * Eigen::Vector3d(v.center + depth_m * v.view)).head<2>();
}

TEST(PoleObservations, MeetAtTheAxisWhicheverSideTheyWereSeenFrom) {
  constexpr double kDepth = std::numbers::pi / 4 * 0.0275;
  std::vector<double> radius(24, 0.0275);
  radius[5] = 0.06;
  const Row row = drive_along(radius, 0);
  const std::vector<PoleObservation> observations =
      gather_observations(row.detections, row.track, kDepth, PoleOptions());
  const std::vector<PolePair> pairs = pairs_of(row, observations, kDepth);
  ASSERT_EQ(pairs.size(), radius.size());  // each trunk with itself, none with its neighbour
  double mean = 0;
  for (const PolePair& p : pairs) {
    const PoleObservation &a = observations[p.first], &b = observations[p.second];
    const Eigen::Vector2d axis = axis_of(a, row.track, p.depth_m), other = axis_of(b, row.track, p.depth_m);
    const auto trunk = static_cast<std::size_t>(std::lround((axis.x() - 3) / 1.5));
    ASSERT_LT(trunk, radius.size());
    // Abreast: neither visit knows how far it is along the lane to the trunk.
    EXPECT_NEAR(row.track.pose(a.time_s).translation.x(), row.trunk_x(trunk), 0.05);
    EXPECT_NEAR(row.track.pose(b.time_s).translation.x(), row.trunk_x(trunk), 0.05);
    if (trunk == 5)
      EXPECT_NEAR(p.depth_m, std::numbers::pi / 4 * 0.06, 0.01);  // though the common depth is less than half of that
    else
      EXPECT_NEAR(p.depth_m, kDepth, 0.008), mean += (other - axis).y() / 23;
    EXPECT_EQ(p.observations, 2);
    EXPECT_GT(p.variance_m2, 0.006 * 0.006);
  }
  EXPECT_NEAR(mean, 0, 0.002);
}

// The error of a lane across the row shows; the thickness of each trunk, which is unknown, takes up only a part of it.
TEST(PoleObservations, ShowThatALaneIsOff) {
  constexpr double kDepth = std::numbers::pi / 4 * 0.0275, kOff = 0.03;
  const Row row = drive_along(std::vector<double>(24, 0.0275), kOff);
  const std::vector<PoleObservation> observations =
      gather_observations(row.detections, row.track, kDepth, PoleOptions());
  double mean = 0;
  const std::vector<PolePair> pairs = pairs_of(row, observations, kDepth);
  ASSERT_EQ(pairs.size(), 24u);
  for (const PolePair& p : pairs)
    mean +=
        (axis_of(observations[p.second], row.track, p.depth_m) - axis_of(observations[p.first], row.track, p.depth_m))
            .y() /
        24;
  EXPECT_GT(mean, 0.1 * kOff);
  EXPECT_LT(mean, kOff);
}

TEST(PoleObservations, OfOtherTimesAndPlacesAreNotPaired) {
  const Row row = drive_along(std::vector<double>(4, 0.0275), 0);
  const std::vector<PoleObservation> observations = gather_observations(row.detections, row.track, 0.02, PoleOptions());
  EXPECT_TRUE(
      pair_observations(observations, row.track, 0.02, {.reach_m = 0.15, .min_gap_s = 1000}, PoleOptions()).empty());
  EXPECT_TRUE(
      pair_observations(observations, row.track, 0.02, {.reach_m = 0.15, .max_gap_s = 5}, PoleOptions()).empty());
  EXPECT_TRUE(gather_observations({}, row.track, 0.02, PoleOptions()).empty());
  EXPECT_TRUE(pair_observations({}, row.track, 0.02, {}, PoleOptions()).empty());
}

}  // namespace
}  // namespace rayfield::slam
