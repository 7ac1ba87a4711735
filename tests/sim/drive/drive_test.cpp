#include "rayfield/sim/drive.h"

#include <Eigen/Geometry>
#include <cmath>

#include "sim/drive/true_trajectory.h"
#include "sim/terrain/block_geometry.h"
#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

Drive small_drive(const Site& site) { return take(plan_drive(make_world(site))); }

TEST(Drive, StandsStillForTheStationaryStartAndNotWithoutOne) {
  Site site = small_site();
  site.vehicle.vibration_m = 0;
  site.dates[0].stationary_start_s = 10;
  const Drive standing = small_drive(site);
  for (double t = 0; t < 9.5; t += 0.1) {
    EXPECT_LT(standing.trajectory->motion(t).velocity.norm(), 1e-3);
    EXPECT_NEAR(standing.trajectory->motion(t).specific_force().norm(), kGravity, 1e-3);
  }
  site.dates[0].stationary_start_s = 0;
  EXPECT_NEAR(small_drive(site).trajectory->motion(0.5).velocity.norm(), site.dates[0].speed_m_s, 0.25);
}

TEST(Drive, FollowsEveryLaneInTheSkippedOrderAtTheAskedSpeed) {
  Site site = small_site();
  site.rows.count = 4;
  site.dates[0].speed_m_s = 1.2;
  const World world = make_world(site);
  const Drive drive = take(plan_drive(world));
  EXPECT_EQ(drive.lanes, (std::vector<int>{0, 2, 4, 3, 1}));
  std::vector<int> driven;
  double sum = 0;
  int count = 0;
  for (double t = 0; t < drive.duration_s(); t += 0.1) {
    const Motion motion = drive.trajectory->motion(t);
    const auto at = world.block().row_position(0, motion.enu_from_imu.translation.head<2>());
    if (at.chainage < 4 || at.chainage > 9) continue;
    const double lane = at.offset / site.rows.spacing_m + 0.5;
    EXPECT_NEAR(lane, std::round(lane), 0.35 / site.rows.spacing_m);  // five standard deviations of the wander
    if (driven.empty() || driven.back() != std::lround(lane)) driven.push_back(static_cast<int>(std::lround(lane)));
    sum += motion.velocity.head<2>().norm(), ++count;
  }
  EXPECT_EQ(driven, drive.lanes);
  EXPECT_NEAR(sum / count, 1.2, 0.08);
}

TEST(Drive, TakesGivenLanesInTheGivenOrder) {
  Site site = small_site();
  site.dates[0].lanes = {2, 0};
  EXPECT_EQ(small_drive(site).lanes, (std::vector<int>{2, 0}));
  site.dates[0].lanes.clear();
  site.dates[0].order = LaneOrder::reverse;
  EXPECT_EQ(small_drive(site).lanes, (std::vector<int>{2, 1, 0}));
}

TEST(Drive, CarriesTheImuAtItsHeightOverTheGround) {
  Site site = bare_site();
  site.vehicle.bump_m = site.vehicle.vibration_m = 0;
  const Drive drive = small_drive(site);
  for (double t = 0; t < drive.duration_s(); t += 0.5)
    EXPECT_NEAR(drive.trajectory->motion(t).enu_from_imu.translation.z(), site.vehicle.imu_height_m, 0.01);
}

TEST(Drive, TiltsWithTheGround) {
  Site site = bare_site();
  site.terrain.slope_percent = 8;
  site.terrain.slope_azimuth_deg = site.rows.azimuth_deg;  // up the rows
  site.vehicle.bump_m = site.vehicle.vibration_m = 0;
  const World world = make_world(site);
  const Drive drive = take(plan_drive(world));
  const Eigen::Vector3d forward = drive.trajectory->pose(0.5).rotation.col(0);
  EXPECT_NEAR(forward.z(), std::sin(std::atan(0.08)), 2e-3);
}

TEST(Drive, DatesDifferByTheirSeed) {
  Site site = small_site();
  const Drive a = small_drive(site);
  site.dates[0].seed = 99;
  const Drive b = small_drive(site);
  EXPECT_GT((a.trajectory->pose(10).translation - b.trajectory->pose(10).translation).norm(), 0.01);
}

}  // namespace
}  // namespace rayfield::sim
