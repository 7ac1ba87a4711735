#include "libslam/global_registration/revisit_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/libslam/straight_track.h"

namespace rayfield::slam {
namespace {

using testing::straight_track;

// Level ground in a world frame: the track must not turn.
Surfel ground(const PoseTrack& track, double time_s, double x, double y, double z) {
  Surfel s;
  s.time_s = time_s;
  s.center = (Eigen::Vector3d(x, y, z) - track.pose(time_s).translation).cast<float>();
  s.normal = Eigen::Vector3f::UnitZ();
  return s;
}

// A surface every 0.1 s that is met again 100 s later, `off(t)` higher.
template <class Off>
RevisitMisfit misfit_of_visits(const PoseTrack& track, const Off& off) {
  std::vector<Surfel> surfels;
  std::vector<SurfelMatch> revisits;
  for (int k = 0; k < 1000; ++k) {
    const double t = 0.1 * k;
    surfels.push_back(ground(track, t, 0.15 * k, 2, 0));
    surfels.push_back(ground(track, t + 100, 0.15 * k, 2, off(t)));
    revisits.push_back({static_cast<std::uint32_t>(2 * k), static_cast<std::uint32_t>(2 * k + 1)});
  }
  RevisitStatistics survey(track.end_s());
  survey.add(track, surfels, revisits);
  return survey.misfit();
}

TEST(RevisitMisfit, IsTheSpreadOfTheSurfacesWhereAllVisitsAgree) {
  const PoseTrack track = straight_track(200, 1.5);
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 0.004);
  const RevisitMisfit m = misfit_of_visits(track, [&](double) { return noise(random); });
  EXPECT_NEAR(m.typical_m, 1.645 * 0.004, 0.001);
  EXPECT_LT(m.worst_m, 1.4 * m.typical_m);
}

TEST(RevisitMisfit, StandsOutWhereALaneLiesOnOtherGround) {
  const PoseTrack track = straight_track(200, 1.5);
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 0.004), other(0, 0.05);
  const RevisitMisfit m =
      misfit_of_visits(track, [&](double t) { return t > 40 && t < 60 ? other(random) : noise(random); });
  EXPECT_NEAR(m.worst_m, 1.645 * 0.05, 0.015);
  EXPECT_TRUE(m.worst_s == 50 || m.worst_s == 150) << m.worst_s;  // either visit
  EXPECT_NEAR(m.typical_m, 1.645 * 0.004, 0.0015);
}

TEST(RevisitMisfit, SaysNothingOfADriveWithHardlyAnyRevisit) {
  const PoseTrack track = straight_track(200, 1.5);
  const std::vector<Surfel> surfels = {ground(track, 10, 0, 0, 0), ground(track, 120, 0, 0, 1)};
  RevisitStatistics survey(track.end_s());
  EXPECT_EQ(survey.misfit().typical_m, 0);
  EXPECT_EQ(survey.thickness_m(), 0);
  survey.add(track, surfels, std::vector<SurfelMatch>{{0, 1}});
  EXPECT_EQ(survey.misfit().typical_m, 0);
}

TEST(LogHistogram, HasTheQuantilesOfWhatItWasGiven) {
  std::mt19937_64 random(7);
  std::exponential_distribution<double> offset(1 / 0.004);
  LogHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), 0);
  for (int k = 0; k < 200000; ++k) histogram.add(offset(random));
  EXPECT_EQ(histogram.count(), 200000u);
  for (const double share : {0.1, 0.5, 0.9, 0.99})
    EXPECT_NEAR(histogram.quantile(share) / (-0.004 * std::log(1 - share)), 1, 0.02) << share;
  LogHistogram extremes;
  extremes.add(0), extremes.add(0), extremes.add(1e6);
  EXPECT_LT(extremes.quantile(0.5), 2e-6);
  EXPECT_NEAR(extremes.quantile(1), 2.5, 0.1);
}

}  // namespace
}  // namespace rayfield::slam
