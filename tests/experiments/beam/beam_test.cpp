#include "rayfield/experiments/beam.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayfield::experiments {
namespace {

// Narrow beams on few leaves: an edge is seen δ = k·D outside of the leaf, k(0.25) = 0.20, and a leaf of area a and
// perimeter p looks larger by g = 1 + (π/2)·(p/a)·δ + 2πδ²/a (docs/beams.md). Rhombi with diagonals 1.05 and 1/1.05
// of √(2a).
TEST(Beam, EchoesThatAreCountedReadAsMuchMoreAsLeavesLookLarger) {
  BeamExperimentOptions options;
  options.diameters_m = {0.01}, options.leaf_sizes_m2 = {0.01}, options.detection_shares = {0.25};
  options.densities_m2_m3 = {0.6}, options.exit_share = 1;
  options.thickness_m = 0.2, options.fans = 2000, options.trials = 12;
  Progress progress;
  const auto result = run_beam(options, progress);
  ASSERT_TRUE(result);
  const double a = 0.01, delta = 0.20 * 0.01;
  const double p = 4 * std::hypot(0.5 * 1.05 * std::sqrt(2 * a), 0.5 / 1.05 * std::sqrt(2 * a));
  const double larger = std::numbers::pi / 2 * p / a * delta + 2 * std::numbers::pi * delta * delta / a;
  const BeamCell& cell = result->cells.at(0);
  const Mean& thin = result->thin.at(0).known;
  const double ratio = (1 + cell.counted.value) / (1 + thin.value);
  EXPECT_NEAR(ratio, 1 + larger, 0.04);
  ASSERT_EQ(cell.not_told, 0U);
  EXPECT_LT(std::abs(cell.known.value - thin.value), larger / 2) << "the correction takes most of it out";
}

class WideBeam : public testing::Test {
 protected:
  static BeamExperimentOptions options() {
    BeamExperimentOptions options;
    options.diameters_m = {0.035}, options.leaf_sizes_m2 = {0.004}, options.detection_shares = {0.25};
    options.densities_m2_m3 = {3}, options.fans = 300, options.trials = 3;
    return options;
  }
};

TEST_F(WideBeam, IsTakenOutWithWhatIsKnownAndWithWhatTheEchoesTell) {
  Progress progress;
  const auto result = run_beam(options(), progress);
  ASSERT_TRUE(result);
  const BeamCell& cell = result->cells.at(0);
  const double thin = result->thin.at(0).known.value;
  EXPECT_EQ(cell.not_told, 0U);
  EXPECT_GT(cell.counted.value - thin, 0.15) << "a beam of half a leaf's side";
  EXPECT_LT(std::abs(cell.known.value - thin), 0.5 * (cell.counted.value - thin));
  EXPECT_LT(std::abs(cell.measured.value - thin), 0.5 * (cell.counted.value - thin));
  EXPECT_NEAR(cell.full_echo.value, 1, 0.2);
}

TEST_F(WideBeam, GivesTheSameAtAnyNumberOfThreads) {
  BeamExperimentOptions few = options();
  Progress progress;
  few.threads = 1;
  const auto one = run_beam(few, progress);
  few.threads = 3;
  const auto three = run_beam(few, progress);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->cells.at(0).counted.value, three->cells.at(0).counted.value);
  EXPECT_EQ(one->cells.at(0).known.value, three->cells.at(0).known.value);
}

TEST_F(WideBeam, WhoseEchoesAreTooFewTellsNothing) {
  BeamExperimentOptions few = options();
  few.fans = 20;  // fewer echoes than estimate_echo_model() wants
  Progress progress;
  const auto result = run_beam(few, progress);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->cells.at(0).not_told, few.trials);
  EXPECT_EQ(result->cells.at(0).measured.value, 0);
}

TEST_F(WideBeam, RefusesWhatIsOutOfRange) {
  Progress progress;
  BeamExperimentOptions inside = options();
  inside.distance_m = 0.2;
  EXPECT_EQ(run_beam(inside, progress).error().where, "distance_m") << "the lidar would stand in the wall";
}

}  // namespace
}  // namespace rayfield::experiments
