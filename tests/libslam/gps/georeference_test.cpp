#include "libslam/gps/georeference.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace rayfield::slam {
namespace {

TEST(CollectFixes, RefusesWhatIsNoPositionAndFloorsOptimisticCovariances) {
  Rig rig;
  rig.gps = Rig::Gps{};
  std::vector<GpsFix> fixes(5);
  for (int k = 0; k < 5; ++k) {
    fixes[k].time_s = 100 + k;
    fixes[k].latitude_deg = -35, fixes[k].longitude_deg = 138, fixes[k].height_m = 50;
    fixes[k].covariance_type = 2;
    fixes[k].covariance_enu_m2 = 1e-6 * Eigen::Matrix3d::Identity();
  }
  fixes[1].status = -1;
  fixes[2].latitude_deg = std::numeric_limits<double>::quiet_NaN();
  fixes[3].latitude_deg = fixes[3].longitude_deg = 0;
  const GpsTrack track = collect_fixes(fixes, rig, 90, 110, 90, GpsOptions());
  ASSERT_EQ(track.positions.size(), 2u);
  EXPECT_EQ(track.invalid, 3u);
  EXPECT_EQ(track.positions[0].sigma_horizontal_m, GpsOptions().min_sigma_m);
  EXPECT_NEAR(track.positions[1].time_s, 14, 1e-12);
}

TEST(MapTrajectory, CarriesConvergenceAndScaleOfTheGrid) {
  // 500 m of track northwards near the edge of a zone, compared with the projection of each point.
  const TangentPlane plane({-35.2186, 138.5411, 82});
  const auto frame = MapFrame::create("EPSG:7854");
  ASSERT_TRUE(frame);
  PoseTrack track;
  for (int k = 0; k <= 500; ++k)
    track.position.emplace_back(0, k, 0), track.rotation.emplace_back(Eigen::Quaterniond::Identity());
  const Trajectory t = map_trajectory(track, 0, plane, *frame);
  const Eigen::Vector3d far = frame->map_from_geodetic(plane.geodetic_from_enu({0, 500, 0}));
  EXPECT_LT((t.poses.back().map_from_body.translation - far).norm(), 1e-6);
  // The IMU's y axis points to true north: on the grid it shows the convergence.
  const Eigen::Vector3d north = t.poses.front().map_from_body.rotation * Eigen::Vector3d::UnitY();
  const double convergence = frame->convergence_rad(t.poses.front().map_from_body.translation);
  EXPECT_NEAR(std::atan2(north.x(), north.y()), -convergence, 2e-5);
  EXPECT_GT(std::abs(convergence), 0.02);
  // Grid metres per metre on the ground: the scale on the ellipsoid, and the height of 82 m above it.
  EXPECT_NEAR(t.horizontal_scale, frame->scale_factor(far) * (1 - 82 / 6.371e6), 1e-6);
}

}  // namespace
}  // namespace rayfield::slam
