#include "libslam/surfels/surfel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace rayfield::slam {
namespace {

PoseTrack still_track(double seconds, const Eigen::Vector3d& position = Eigen::Vector3d(0, 0, 2)) {
  PoseTrack t;
  for (int k = 0; k <= static_cast<int>(seconds * 100); ++k)
    t.position.push_back(position), t.rotation.emplace_back(Eigen::Quaterniond::Identity());
  return t;
}

// Points of the plane n·p = d around `at`, with noise along n.
std::vector<BodyPoint> plane_points(const Eigen::Vector3d& n, const Eigen::Vector3d& at, double noise, int count,
                                    const PoseTrack& track) {
  std::mt19937 generator(3);
  std::normal_distribution<double> gauss(0, 1);
  std::uniform_real_distribution<double> spread(-0.5, 0.5);
  const Eigen::Vector3d u = n.unitOrthogonal(), v = n.cross(u);
  std::vector<BodyPoint> out;
  for (int k = 0; k < count; ++k) {
    const double time = 0.4 * k / count;
    const Eigen::Vector3d p = at + spread(generator) * u + spread(generator) * v + noise * gauss(generator) * n;
    out.push_back({time, (track.pose(time).inverse() * p).cast<float>(), 0});
  }
  return out;
}

TEST(ExtractSurfels, FindsThePlaneItsThicknessAndTheSideOfTheSensor) {
  const PoseTrack track = still_track(1);
  const Eigen::Vector3d n = Eigen::Vector3d(0.2, -0.1, 1).normalized(), at(3, 1, 0);
  SurfelOptions options;
  options.voxel_size_m = {0.6};
  const auto surfels =
      extract_features(plane_points(n, at, 0.01, 4000, track), BeamSource(), track, options, {}).surfels;
  ASSERT_GT(surfels.size(), 4u);
  // Where a face of a cell cuts the noisy layer lengthways the cell sees a part of its thickness only: each surfel is
  // held to one standard deviation of the noise, the typical one to a third.
  std::vector<double> offset, alignment, thickness;
  for (const Surfel& s : surfels) {
    const Eigen::Vector3d center = track.pose(s.time_s) * s.center.cast<double>();
    if ((center - at).norm() > 0.35) continue;  // cells at the rim hold slivers
    offset.push_back(std::abs(n.dot(center - at)));
    alignment.push_back(static_cast<double>(s.normal.dot(n.cast<float>())));  // the sensor is above
    thickness.push_back(std::sqrt(static_cast<double>(s.variance_m2)));
    EXPECT_LT(offset.back(), 0.01);
    EXPECT_GT(alignment.back(), 0.99);
    EXPECT_LT(thickness.back(), 0.012);
  }
  ASSERT_GT(offset.size(), 2U);
  for (auto* values : {&offset, &alignment, &thickness}) std::sort(values->begin(), values->end());
  EXPECT_LT(offset[offset.size() / 2], 0.003);
  EXPECT_GT(alignment[alignment.size() / 2], 0.999);
  EXPECT_NEAR(thickness[thickness.size() / 2], 0.01, 0.002);
}

TEST(ExtractSurfels, SeesAPlaneAsOneThoughTheVehicleMovedWhileMeasuringIt) {
  PoseTrack track;
  for (int k = 0; k <= 100; ++k) {
    track.position.emplace_back(0.03 * k, 0, 2);
    track.rotation.push_back(exp_so3(Eigen::Vector3d(0, 0.002 * k, 0.01 * k)));
  }
  SurfelOptions options;
  options.voxel_size_m = {0.6};
  for (const Surfel& s : extract_features(plane_points(Eigen::Vector3d::UnitZ(), {3, 1, 0}, 0, 4000, track),
                                          BeamSource(), track, options, {})
                             .surfels) {
    EXPECT_LT(static_cast<double>(s.variance_m2), 1e-10);
    EXPECT_NEAR((track.pose(s.time_s) * s.center.cast<double>()).z(), 0, 2e-4);
  }
}

// 2 m below the sensor and 4 m ahead a beam of D meets level ground at tan = 4/2: its spot is 2·D deep.
TEST(BeamSource, SpotsAreAsDeepAsTheirDiameterTimesTheTangent) {
  const BeamSource wide{{0.1, 0, 0}, {0.0136, 0.0119, {}}};
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(wide.spot_depth_m({4.1, 0, -2}, up), 2 * (0.0136 + 0.0119 * std::sqrt(20.0)), 1e-12);
  EXPECT_NEAR(wide.spot_depth_m({4.1, 0, -2}, -up), 2 * (0.0136 + 0.0119 * std::sqrt(20.0)), 1e-12);
  EXPECT_NEAR(wide.spot_depth_m({0.1, 0, -2}, up), 0, 1e-12);
  EXPECT_TRUE(std::isinf(wide.spot_depth_m({4.1, 0, 0}, up)));
  EXPECT_EQ(BeamSource().spot_depth_m({4, 0, 0}, up), 0);
}

TEST(ExtractSurfels, LeavesOutWhatAWideBeamLightsMoreAslantThanTheLidarResolves) {
  const PoseTrack track = still_track(1);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  SurfelOptions options;
  options.voxel_size_m = {0.6}, options.max_spot_depth_m = 0.15;
  const BeamSource wide{Eigen::Vector3d::Zero(), {0.0136, 0.0119, {}}};
  const auto near = plane_points(up, {1.5, 0, 0}, 0.003, 4000, track);  // spots 0.03 m deep
  const auto far = plane_points(up, {7, 0, 0}, 0.003, 4000, track);     // 0.35 m
  EXPECT_FALSE(extract_features(near, wide, track, options, {}).surfels.empty());
  EXPECT_TRUE(extract_features(far, wide, track, options, {}).surfels.empty());
  EXPECT_FALSE(extract_features(far, BeamSource(), track, options, {}).surfels.empty());
  options.max_spot_depth_m = 0.5;
  EXPECT_FALSE(extract_features(far, wide, track, options, {}).surfels.empty());
}

TEST(ExtractSurfels, GivesNothingForASingleScanLineOrABall) {
  const PoseTrack track = still_track(1);
  std::vector<BodyPoint> line, ball;
  std::mt19937 generator(5);
  std::normal_distribution<float> gauss(0, 0.1f);
  for (int k = 0; k < 500; ++k) {
    line.push_back({0.1, {2.0f + 0.002f * static_cast<float>(k), 1, -2}, 0});
    ball.push_back({0.1, {2.0f + gauss(generator), 1 + gauss(generator), -1 + gauss(generator)}, 0});
  }
  SurfelOptions options;
  options.voxel_size_m = {1.2};
  EXPECT_TRUE(extract_features(line, BeamSource(), track, options, {}).surfels.empty());
  for (const Surfel& s : extract_features(ball, BeamSource(), track, options, {}).surfels)
    EXPECT_GT(static_cast<double>(s.variance_m2), 1e-3);  // a cut ball may look flat, but never thin
  EXPECT_TRUE(extract_features({}, BeamSource(), track, options, {}).surfels.empty());
}

}  // namespace
}  // namespace rayfield::slam
