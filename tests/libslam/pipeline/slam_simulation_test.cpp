#include <gtest/gtest.h>

#include "rayfield/core/map_frame.h"
#include "rayfield/sim/sim.h"
#include "rayfield/slam/slam.h"
#include "tests/libslam/trajectory_errors.h"
#include "tests/sim/without_errors.h"

// Drives that go wrong in one way each, simulated; the goals hold by half as much again.
namespace rayfield::slam {
namespace {

sim::Site vineyard() {
  sim::Site site;
  site.name = "slam";
  site.rows.azimuth_deg = 24;
  site.terrain.slope_percent = 5, site.terrain.slope_azimuth_deg = 24, site.terrain.relief_m = 0.3;
  site.canopy.leaf_area_m2_per_m = 2.75;
  site.surroundings.trees = 6, site.surroundings.buildings = 2;
  sim::SiteDate date;
  date.date = "2019-02-11";
  date.seed = 2;
  site.dates = {date};
  return site;
}

struct Outcome {
  Result<SlamResult> result;
  testing::TrajectoryErrors errors;
  double mean_gps_error_m = 0;
  std::vector<TimedPose> truth;  // in the map
};

// `ask` switches on what the rig may ask to be estimated.
Outcome drive(const sim::Site& site, const std::function<void(Rig&)>& ask = {}) {
  Progress progress;
  auto world = sim::build_world(site, 0, 0, progress);
  EXPECT_TRUE(world) << world.error().line();
  auto plan = sim::plan_drive(*world);
  EXPECT_TRUE(plan);
  Rig rig = sim::site_rig(site);
  if (ask) ask(rig);
  const LogReader read = [&](SensorSink& sink) -> Result<void> {
    const auto done = sim::simulate(*world, *plan, sink, {}, {}, progress);
    if (!done) return tl::make_unexpected(done.error());
    return {};
  };
  Outcome out{run_slam(read, rig, site.crs_code(), SlamOptions(), progress), {}, 0, {}};
  if (!out.result) return out;
  const auto frame = MapFrame::create(site.crs_code());
  const TangentPlane plane({site.latitude_deg, site.longitude_deg, site.height_m});
  const Eigen::Matrix3d j = map_from_enu_jacobian(*frame, plane, Eigen::Vector3d::Zero());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(std::atan2(j(1, 0), j(0, 0)), Eigen::Vector3d::UnitZ()));
  std::vector<TimedPose> truth = plan->poses(100);
  for (TimedPose& p : truth) {
    p.map_from_body.translation = frame->map_from_geodetic(plane.geodetic_from_enu(p.map_from_body.translation));
    p.map_from_body.rotation = turn * p.map_from_body.rotation;
  }
  out.errors = testing::trajectory_errors(out.result->trajectory.poses, truth);
  for (const GpsMark& m : out.result->gps)
    out.mean_gps_error_m += (m.position - testing::pose_at(truth, m.time_s) * rig.imu_from_gps_m).norm() /
                            static_cast<double>(out.result->gps.size());
  out.truth = std::move(truth);
  return out;
}

// Normalised squared errors of the positions against the pose in the middle of the drive, mean over poses and axes:
// 1 where the reported standard deviations are right.
double normalised_error(const SlamResult& result, const std::vector<TimedPose>& truth) {
  const auto& estimate = result.trajectory.poses;
  const double middle = 0.5 * (estimate.front().time_s + estimate.back().time_s);
  const Rigid3 a = testing::pose_at(estimate, middle), b = testing::pose_at(truth, middle);
  const Eigen::Matrix3d turn = (b.rotation * a.rotation.conjugate()).toRotationMatrix();
  const Eigen::Quaterniond yaw(Eigen::AngleAxisd(std::atan2(turn(1, 0), turn(0, 0)), Eigen::Vector3d::UnitZ()));
  double sum = 0;
  int count = 0;
  for (const PoseSigma& u : result.report.uncertainty) {
    if (std::abs(u.time_s - middle) < 5) continue;  // next to the pose that is held both vanish
    const Eigen::Vector3d e = yaw * (testing::pose_at(estimate, u.time_s).translation - a.translation) -
                              (testing::pose_at(truth, u.time_s).translation - b.translation);
    sum += e.cwiseQuotient(u.translation_m).squaredNorm() / 3;
    ++count;
  }
  return sum / std::max(1, count);
}

void expect_goals(const Outcome& o, double factor) {
  ASSERT_TRUE(o.result) << o.result.error().line();
  EXPECT_LE(o.errors.ate_rms_m, 0.05 * factor);
  EXPECT_LE(o.errors.ate_max_m, 0.15 * factor);
  EXPECT_LE(o.errors.drift_percent, 0.5 * factor);
  if (!o.result->gps.empty()) {
    EXPECT_LE(o.errors.georeferenced_rms_m, o.mean_gps_error_m + 0.10 * factor);
  }
}

TEST(SimulatedDrive, MeetsTheGoalsAndKnowsHowWell) {
  const Outcome o = drive(vineyard());
  expect_goals(o, 1);
  // Neither twice too sure (4) nor ten times too modest (0.01).
  EXPECT_LT(normalised_error(*o.result, o.truth), 4);
  EXPECT_GT(normalised_error(*o.result, o.truth), 0.01);
  // π/4 of the mean radius: trunks of 5.5 cm, a post of 7 cm for every four of them.
  EXPECT_GT(o.result->report.poles_m.count, 100u);
  EXPECT_NEAR(o.result->report.pole_depth_m, 0.0225, 0.004);
}

TEST(SimulatedDrive, MeetsTheGoalsWithoutSensorErrorsToACentimetre) {
  const Outcome o = drive(sim::without_errors(vineyard()));
  ASSERT_TRUE(o.result) << o.result.error().line();
  EXPECT_LE(o.errors.ate_rms_m, 0.01);
}

TEST(SimulatedDrive, HoldsThroughAGpsOutageOfAMinute) {
  sim::Site site = vineyard();
  site.dates[0].gps_outages = {{30, 60}};
  const Outcome o = drive(site);
  expect_goals(o, 1.5);
  EXPECT_NEAR(o.result->report.gps.longest_outage_s, 60, 1);
}

TEST(SimulatedDrive, HoldsWhenGpsJumpsByFiveMetres) {
  sim::Site site = vineyard();
  site.dates[0].gps_jumps = {{25, 10, 4, 3, 0}, {70, 10, -3, 4, 0}};
  const Outcome o = drive(site);
  ASSERT_TRUE(o.result) << o.result.error().line();
  EXPECT_LE(o.errors.ate_rms_m, 0.075);
  EXPECT_GE(o.result->report.gps.outliers, 150u);  // of the 200 fixes that jumped
}

TEST(SimulatedDrive, HoldsWhenTheGpsBiasWandersByTwoMetres) {
  sim::Site site = vineyard();
  site.gps.bias_horizontal_m = 2;
  expect_goals(drive(site), 1.5);
}

TEST(SimulatedDrive, HoldsWithThreeTimesTheImuNoise) {
  sim::Site site = vineyard();
  site.dates[0].imu_noise_scale = 3;
  const Outcome o = drive(site);
  expect_goals(o, 1.5);
  // The rig file does not know of the noise; the uncertainty must all the same.
  EXPECT_LT(normalised_error(*o.result, o.truth), 3);
}

TEST(SimulatedDrive, HoldsWithHalfTheLidarRate) {
  sim::Site site = vineyard();
  site.spinning.rate_hz = 50;
  expect_goals(drive(site), 1.5);
}

TEST(SimulatedDrive, HoldsOnFlatLandWithoutTreesOrBuildings) {
  sim::Site site = vineyard();
  site.terrain.slope_percent = 0, site.terrain.relief_m = 0;
  site.surroundings = {0, 0, false};
  expect_goals(drive(site), 1.5);
}

TEST(SimulatedDrive, HoldsWhenTheLogBeginsInMotion) {
  sim::Site site = vineyard();
  site.dates[0].stationary_start_s = 0;
  expect_goals(drive(site), 1.5);
}

TEST(SimulatedDrive, FindsALidarClockThatIsTwentyMillisecondsOff) {
  sim::Site site = vineyard();
  site.dates[0].lidar_time_error_s = 0.02;
  const Outcome o = drive(site, [](Rig& rig) { rig.estimate_lidar_offset = true; });
  expect_goals(o, 1.5);
  ASSERT_EQ(o.result->report.offsets.size(), 1u);
  EXPECT_NEAR(o.result->report.offsets[0].value, 0.02, 0.001);
}

TEST(SimulatedDrive, FindsASpinnerEncoderThatIsAboutADegreeOff) {
  sim::Site site = vineyard();
  site.dates[0].spinner_angle_error_rad = 0.02;
  const Outcome o = drive(site, [](Rig& rig) { rig.estimate_spinner_offset = true; });
  expect_goals(o, 1.5);
  ASSERT_EQ(o.result->report.offsets.size(), 1u);
  EXPECT_NEAR(o.result->report.offsets[0].value, 0.02, 0.001);
}

TEST(SimulatedDrive, FindsAGpsClockThatIsOffWithinItsStatedUncertainty) {
  sim::Site site = vineyard();
  site.dates[0].gps_time_error_s = 0.2;
  const Outcome o = drive(site, [](Rig& rig) { rig.estimate_gps_offset = true; });
  expect_goals(o, 1.5);
  ASSERT_EQ(o.result->report.offsets.size(), 1u);
  const OffsetEstimate& e = o.result->report.offsets[0];
  EXPECT_NEAR(e.value, 0.2, 3 * e.sigma);
  EXPECT_LT(e.sigma, 0.05);
}

// Rows so long that a lane drifts by the width of a row before it is seen again.
sim::Site long_rows() {
  sim::Site site = vineyard();
  site.rows.count = 5, site.rows.length_m = 110;
  site.rows.azimuth_deg = 66;
  return site;
}

TEST(SimulatedDrive, KeepsLongLanesApartWithThreeTimesTheImuNoise) {
  sim::Site site = long_rows();
  site.dates[0].imu_noise_scale = 3;
  expect_goals(drive(site), 1.5);
}

TEST(SimulatedDrive, KeepsLongLanesApartWhenTheGpsBiasWandersByTwoMetres) {
  sim::Site site = long_rows();
  site.gps.bias_horizontal_m = 2;
  expect_goals(drive(site), 1.5);
}

TEST(SimulatedDrive, RefusesMountingsThatAreWrong) {
  const std::pair<const char*, std::function<void(Rig&)>> wrong[] = {
      {"axis negated", [](Rig& rig) { rig.spinner->axis = -rig.spinner->axis; }},
      {"lidar turned about the spinner's axis",
       [](Rig& rig) {
         const Eigen::Quaterniond quarter(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
         rig.spinner_from_lidar.rotation = quarter * rig.spinner_from_lidar.rotation;
       }},
      {"IMU upside down",
       [](Rig& rig) {
         const Eigen::Quaterniond over(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
         rig.imu_from_spinner.rotation = over * rig.imu_from_spinner.rotation;
       }},
  };
  for (const auto& [name, spoil] : wrong) {
    const Outcome o = drive(vineyard(), spoil);
    ASSERT_FALSE(o.result) << name;
    EXPECT_EQ(o.result.error().code, ErrorCode::bad_input) << name << ": " << o.result.error().line();
  }
}

TEST(SimulatedDrive, HoldsWithAFixedMultiBeamLidar) {
  sim::Site site = vineyard();
  site.lidar.kind = sim::LidarKind::multi_beam;
  expect_goals(drive(site), 1.5);
}

}  // namespace
}  // namespace rayfield::slam
