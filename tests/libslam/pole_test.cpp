#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "libslam/global/global_terms.h"
#include "libslam/surfels/pole_visits.h"
#include "libslam/surfels/surfel.h"

namespace rayfield::slam {
namespace {

const Eigen::Vector3d kSensor(0, 0, 1.6);

// A scan line up and down at the azimuth of (x, y), ranges with noise.
void add_line(double x, double y, double low, double high, double noise, std::mt19937& generator,
              std::vector<BodyPoint>& out) {
  std::normal_distribution<double> gauss(0, noise);
  for (double z = low; z < high; z += 0.035) {
    const Eigen::Vector3d beam = Eigen::Vector3d(x, y, z) - kSensor;
    const Eigen::Vector3d p = beam * (1 + gauss(generator) / beam.norm());
    out.push_back({0.1, p.cast<float>(), 0});
  }
}

PoseTrack still_track(const Eigen::Vector3d& position) {
  PoseTrack t;
  for (int k = 0; k <= 100; ++k)
    t.position.push_back(position), t.rotation.emplace_back(Eigen::Quaterniond::Identity());
  return t;
}

TEST(FindPoles, SeesATrunkInAScanLineButNoWallGroundOrFoliage) {
  std::mt19937 generator(7);
  std::vector<BodyPoint> points;
  add_line(2.0, 0.4, 0.25, 0.9, 0.012, generator, points);                                      // trunk
  for (double y = -2; y < -1; y += 0.05) add_line(2.5, y, 0.2, 1.6, 0.012, generator, points);  // wall
  std::uniform_real_distribution<float> spread(-0.3f, 0.3f);
  for (int k = 0; k < 600; ++k) {
    const Eigen::Vector3f at(spread(generator), spread(generator), spread(generator));
    points.push_back({0.1, Eigen::Vector3f(2, 3, -0.2f) + at, 0});                                    // foliage
    points.push_back({0.1, Eigen::Vector3f(2 + 3 * at.x(), 4 * at.y(), -1.6f + 0.02f * at.z()), 0});  // ground
  }
  const auto poles =
      extract_features(points, Eigen::Vector3d::Zero(), still_track(kSensor), SurfelOptions(), PoleOptions()).poles;
  ASSERT_GE(poles.size(), 2u);
  const Eigen::Vector3f towards = -Eigen::Vector3f(2.0f, 0.4f, 0).normalized();
  for (const Surfel& s : poles) {
    EXPECT_NEAR(s.center.x(), 2.0, 0.02);
    EXPECT_NEAR(s.center.y(), 0.4, 0.02);
    EXPECT_GT(s.normal.dot(towards), 0.999f);
  }
}

// Two lanes on either side of a row of trunks, driven in opposite directions; every fifth of a second each trunk nearer
// than three metres shows one scan line, anywhere on it.
struct Row {
  std::vector<double> radius_m;  // a trunk every 1.5 m, from x = 3 on
  PoseTrack track;
  std::vector<Surfel> sightings;
  double trunk_x(std::size_t k) const { return 3 + 1.5 * static_cast<double>(k); }
};

Row drive_along(const std::vector<double>& radius_m, double across_error_m) {
  Row row;
  row.radius_m = radius_m;
  const double length = 6 + 1.5 * static_cast<double>(radius_m.size()), turn_s = 15;  // at 1 m/s
  PoseTrack truth;
  for (int k = 0; 0.01 * k <= 2 * length + turn_s; ++k) {
    const double t = 0.01 * k, f = std::clamp((t - length) / turn_s, 0.0, 1.0), turned = f * f * (3 - 2 * f);
    const double x = std::min(t, length) - std::max(0.0, t - length - turn_s);
    truth.position.emplace_back(x, 1.4 * (2 * turned - 1), 1.6);
    truth.rotation.emplace_back(Eigen::AngleAxisd(std::numbers::pi * turned, Eigen::Vector3d::UnitZ()));
    row.track.position.push_back(truth.position.back() + Eigen::Vector3d(0, turned * across_error_m, 0));
  }
  row.track.rotation = truth.rotation;
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  std::normal_distribution<double> noise(0, 0.004);
  for (double t = 0; t < truth.end_s(); t += 0.2)
    for (std::size_t k = 0; k < radius_m.size(); ++k) {
      const Rigid3 pose = truth.pose(t);
      const Eigen::Vector3d axis(row.trunk_x(k), 0, 0.5), to = axis - pose.translation;
      if (to.head<2>().norm() > 3) continue;
      const Eigen::Vector3d view = Eigen::Vector3d(to.x(), to.y(), 0).normalized(), side(-view.y(), view.x(), 0);
      const double u = anywhere(generator), r = radius_m[k];
      const Eigen::Vector3d hit = axis + u * r * side - (std::sqrt(1 - u * u) * r + noise(generator)) * view;
      Surfel s;
      s.time_s = t;
      s.center = (pose.inverse() * hit).cast<float>();
      s.normal = (pose.rotation.conjugate() * Eigen::Vector3d(-view)).cast<float>();
      row.sightings.push_back(s);
    }
  return row;
}

std::vector<PolePair> pairs_of(const Row& row, const std::vector<PoleVisit>& visits, double depth_m) {
  return pair_visits(visits, row.track, depth_m, {.reach_m = 0.15}, PoleOptions());
}

Eigen::Vector2d axis_of(const PoleVisit& v, const PoseTrack& track, double depth_m) {
  return (track.pose(v.time_s) * Eigen::Vector3d(v.center + depth_m * v.view)).head<2>();
}

TEST(PoleVisits, MeetAtTheAxisWhicheverSideTheyWereSeenFrom) {
  constexpr double kDepth = std::numbers::pi / 4 * 0.0275;
  std::vector<double> radius(24, 0.0275);
  radius[5] = 0.06;
  const Row row = drive_along(radius, 0);
  const std::vector<PoleVisit> visits = gather_visits(row.sightings, row.track, kDepth, PoleOptions());
  const std::vector<PolePair> pairs = pairs_of(row, visits, kDepth);
  ASSERT_EQ(pairs.size(), radius.size());  // each trunk with itself, none with its neighbour
  double mean = 0;
  for (const PolePair& p : pairs) {
    const PoleVisit &a = visits[p.first], &b = visits[p.second];
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
    EXPECT_EQ(p.visits, 2);
    EXPECT_GT(p.variance_m2, 0.006 * 0.006);
  }
  EXPECT_NEAR(mean, 0, 0.002);
}

// What a lane is off across the row shows; thickness, which every trunk has its own of, takes only a part of it.
TEST(PoleVisits, ShowThatALaneIsOff) {
  constexpr double kDepth = std::numbers::pi / 4 * 0.0275, kOff = 0.03;
  const Row row = drive_along(std::vector<double>(24, 0.0275), kOff);
  const std::vector<PoleVisit> visits = gather_visits(row.sightings, row.track, kDepth, PoleOptions());
  double mean = 0;
  const std::vector<PolePair> pairs = pairs_of(row, visits, kDepth);
  ASSERT_EQ(pairs.size(), 24u);
  for (const PolePair& p : pairs)
    mean += (axis_of(visits[p.second], row.track, p.depth_m) - axis_of(visits[p.first], row.track, p.depth_m)).y() / 24;
  EXPECT_GT(mean, 0.1 * kOff);
  EXPECT_LT(mean, kOff);
}

// A fair IMU and no surfels; one step.
TEST(PoleVisits, BringALaneHome) {
  constexpr double kOff = 0.03;
  const Row row = drive_along(std::vector<double>(24, 0.0275), kOff);
  const Row right = drive_along(std::vector<double>(24, 0.0275), 0);
  OdometryResult odometry;
  odometry.track = row.track, odometry.poles = row.sightings;
  odometry.inertial.push_back({10, {}});
  odometry.noise = {3e-4, 0.01, 1, 1};
  ImuGrid imu(0, odometry.track.step_s);
  const double dt = odometry.track.step_s;
  for (int k = 0; k < right.track.size(); ++k) {
    const int n = std::clamp(k, 1, right.track.size() - 2);
    const auto& p = right.track.position;
    const Eigen::Quaterniond &r0 = right.track.rotation[n - 1], &r1 = right.track.rotation[n + 1];
    const Eigen::Vector3d force = (p[n + 1] - 2 * p[n] + p[n - 1]) / (dt * dt) + Eigen::Vector3d(0, 0, 9.80665);
    imu.add({k * dt, log_so3(r0.conjugate() * r1) / (2 * dt), right.track.rotation[n].conjugate() * force});
  }
  const Rig rig;
  const SlamOptions options;
  GlobalProblem problem(odometry, imu, {}, rig, options, 1.0, {.pole_depth_m = options.poles.depth_m});
  GlobalStats stats;
  problem.begin({});
  problem.add_poles({.reach_m = 0.15});
  problem.end(stats);
  EXPECT_EQ(stats.poles.count, 24u);
  ASSERT_TRUE(problem.solve_and_apply());
  const auto across = [&](double time_s) { return odometry.track.pose(time_s).translation.y(); };
  const double apart = across(odometry.track.end_s() - 20) - across(20);
  // What is left and the depth go together: lanes and trunks alone do not tell a thicker trunk from a wider alley.
  const double deeper = problem.unknowns().pole_depth_m - std::numbers::pi / 4 * 0.0275;
  EXPECT_NEAR(apart, 2.8 + 2 * 0.85 * deeper, 0.006);
}

TEST(PoleVisits, OfOtherTimesAndPlacesAreNotPaired) {
  const Row row = drive_along(std::vector<double>(4, 0.0275), 0);
  const std::vector<PoleVisit> visits = gather_visits(row.sightings, row.track, 0.02, PoleOptions());
  EXPECT_TRUE(pair_visits(visits, row.track, 0.02, {.reach_m = 0.15, .min_gap_s = 1000}, PoleOptions()).empty());
  EXPECT_TRUE(pair_visits(visits, row.track, 0.02, {.reach_m = 0.15, .max_gap_s = 5}, PoleOptions()).empty());
  EXPECT_TRUE(gather_visits({}, row.track, 0.02, PoleOptions()).empty());
  EXPECT_TRUE(pair_visits({}, row.track, 0.02, {}, PoleOptions()).empty());
}

}  // namespace
}  // namespace rayfield::slam
