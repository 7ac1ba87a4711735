#include "libslam/gps/gps_alignment.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace rayfield::slam {
namespace {

PoseTrack loop_track() {
  PoseTrack t;
  for (int k = 0; k <= 6000; ++k) {
    const double s = 0.01 * k;
    t.position.emplace_back(20 * std::cos(0.1 * s), 12 * std::sin(0.1 * s), 0.5 * std::sin(0.2 * s));
    t.rotation.push_back(exp_so3(Eigen::Vector3d(0, 0, 0.1 * s)));
  }
  return t;
}

const Eigen::Vector3d kArm(-0.4, 0.1, 0.5);

std::vector<GpsPosition> fixes_of(const PoseTrack& track, const Rigid3& enu_from_world, double noise_m) {
  std::mt19937 generator(4);
  std::normal_distribution<double> gauss(0, noise_m);
  std::vector<GpsPosition> out;
  for (double t = 0; t < 60; t += 0.1)
    out.push_back({t,
                   enu_from_world * (track.pose(t) * kArm) +
                       Eigen::Vector3d(gauss(generator), gauss(generator), gauss(generator)),
                   0.5, 1.0});
  return out;
}

const Rigid3 kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(1.234, Eigen::Vector3d::UnitZ())), {10, -20, 5}};

TEST(GpsAlignment, FindsYawAndTranslationThroughTheLeverArm) {
  const PoseTrack track = loop_track();
  const GpsAlignment a = align_to_gps(track, fixes_of(track, kTruth, 1e-12), kArm, GpsOptions());
  ASSERT_TRUE(a.solved);
  EXPECT_LT(a.enu_from_world.rotation.angularDistance(kTruth.rotation), 1e-7);
  EXPECT_LT((a.enu_from_world.translation - kTruth.translation).norm(), 1e-6);
}

TEST(GpsAlignment, IsNotMovedByAJumpOfFiveMetres) {
  const PoseTrack track = loop_track();
  auto fixes = fixes_of(track, kTruth, 0.2);
  for (GpsPosition& f : fixes)
    if (f.time_s > 20 && f.time_s < 30) f.enu += Eigen::Vector3d(4, 3, 0);
  const GpsAlignment a = align_to_gps(track, fixes, kArm, GpsOptions());
  ASSERT_TRUE(a.solved);
  // A sixth of the fixes is off by 5 m; plain least squares would move by 0.83 m.
  EXPECT_LT(((a.enu_from_world.inverse() * kTruth).translation).norm(), 0.15);
}

TEST(GpsAlignment, DoesNotClaimAYawForAVehicleThatStoodStillOrHadTooFewFixes) {
  PoseTrack track = loop_track();
  auto fixes = fixes_of(track, kTruth, 0.2);
  EXPECT_FALSE(align_to_gps(track, std::span(fixes).first(10), kArm, GpsOptions()).solved);
  for (auto& p : track.position) p.setZero();
  EXPECT_FALSE(align_to_gps(track, fixes, kArm, GpsOptions()).solved);
}

TEST(GpsOffset, IsFoundThroughAWanderingBiasAndAJump) {
  const PoseTrack track = loop_track();
  auto fixes = fixes_of(track, Rigid3(), 0.03);
  for (GpsPosition& f : fixes) {
    f.enu += Eigen::Vector3d(0.5 * std::sin(0.05 * f.time_s), 0.4 * std::cos(0.04 * f.time_s), 0);
    if (f.time_s > 31 && f.time_s < 36) f.enu.x() += 5;
    f.time_s -= 0.25;  // stamped a quarter of a second early
  }
  const GpsOffsetFit fit = fit_gps_offset(track, fixes, kArm);
  ASSERT_TRUE(fit.solved);
  EXPECT_NEAR(fit.offset_s, 0.25, 3 * fit.sigma_s + 0.01);
  EXPECT_LT(fit.sigma_s, 0.08);
}

TEST(GpsOffset, IsNotClaimedForAStraightDrive) {
  PoseTrack track = loop_track();
  for (int k = 0; k < track.size(); ++k)
    track.position[k] = Eigen::Vector3d(0.015 * k, 0, 0), track.rotation[k] = Eigen::Quaterniond::Identity();
  EXPECT_FALSE(fit_gps_offset(track, fixes_of(track, Rigid3(), 0.03), kArm).solved);
}

}  // namespace
}  // namespace rayfield::slam
