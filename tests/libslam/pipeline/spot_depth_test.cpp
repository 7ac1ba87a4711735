#include "libslam/pipeline/spot_depth.h"

#include <gtest/gtest.h>

#include <optional>

namespace rayfield::slam {
namespace {

/// How often the log is read for a limit, and the limit.
struct Chosen {
  int readings = 0;
  double limit_m = 0;
};

Chosen choose(std::optional<ReturnMode> returns, std::optional<double> told_m = std::nullopt) {
  Rig rig;
  rig.lidar.beam = LidarBeam{0.0136, 0.0119, {}};
  rig.lidar.beam->returns = returns, rig.lidar.beam->range_resolution_m = told_m;
  Chosen chosen;
  const LogReader empty_log = [&chosen](SensorSink&) -> Result<void> {
    ++chosen.readings;
    return {};
  };
  Progress progress;
  const auto spots = choose_spot_depth(empty_log, rig, {}, progress);
  EXPECT_TRUE(spots.has_value()) << "an empty log leaves the limit unmeasured";
  if (spots) chosen.limit_m = spots->limit_m;
  return chosen;
}

TEST(SpotDepth, IsMeasuredFromTheLogWhereTheFirstEchoIsReported) {
  EXPECT_EQ(choose(ReturnMode::first).readings, 1);
  EXPECT_EQ(choose(std::nullopt).readings, 1) << "not known: taken for the first";
  EXPECT_EQ(choose(ReturnMode::first).limit_m, 0.15);
}

// The strongest echo of a deep spot lies about its middle, which would look like a coarse resolution.
TEST(SpotDepth, IsNotMeasuredOfOtherEchoes) {
  for (const ReturnMode mode : {ReturnMode::strongest, ReturnMode::last}) {
    EXPECT_EQ(choose(mode).readings, 0);
    EXPECT_EQ(choose(mode).limit_m, 0.15);
  }
  EXPECT_EQ(choose(ReturnMode::strongest, 0.3).limit_m, 0.3) << "as the rig says";
}

}  // namespace
}  // namespace rayfield::slam
