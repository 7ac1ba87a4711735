#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <thread>

#include "tests/cli/drive_logs.h"

namespace rayfield::test {
namespace {

// Whichever is first has it; the other is refused, or comes after it.
TEST(SlamOutputs, TwoAtOnceOnOneCloudLeaveAWholeOne) {
  const Folder drive, work, calm;
  const SimulatedLog log = simulate_drive(drive);
  ASSERT_FALSE(log.bag.empty());
  const auto slam = [&](const Folder& folder) {
    return rayfield({"slam", log.bag, "--rig", log.rig, "-o", folder.path("a.ply"), "--report", folder.path("a.json"),
                     "--threads", "1", "-q"});
  };
  const Outcome alone = slam(calm);
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  std::array<Outcome, 2> runs;
  std::thread other([&] { runs[1] = slam(work); });
  runs[0] = slam(work);
  other.join();
  std::sort(runs.begin(), runs.end(), [](const Outcome& a, const Outcome& b) { return a.exit_code < b.exit_code; });
  EXPECT_EQ(runs[0].exit_code, 0) << runs[0].err;
  EXPECT_EQ(runs[1].exit_code, 2) << runs[1].err;
  EXPECT_THAT(runs[1].err, testing::AnyOf(testing::HasSubstr("another rayfield is writing it"),
                                          testing::HasSubstr("there already")));
  EXPECT_EQ(read_file(work.path("a.ply")), read_file(calm.path("a.ply")));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(work.path()), std::filesystem::directory_iterator()), 2);
}

// The rig says that the strongest echo is reported, which a log of several echoes knows better.
TEST(SlamOutputs, ALogOfSeveralEchoesGivesTheCloudOfTheFirst) {
  const std::string beam = "beam_diameter_m = 0.0136\ndivergence_mrad = 11.9\nsub_rays = 7\n";
  const Folder one, several;
  const SimulatedLog logs[] = {simulate_drive(one, beam), simulate_drive(several, beam + "echoes = 5")};
  std::string rig = read_file(logs[1].rig);
  const std::string first = "returns = \"first\"";
  ASSERT_NE(rig.find(first), std::string::npos) << rig;
  write_file(logs[1].rig, rig.replace(rig.find(first), first.size(), "returns = \"strongest\""));
  std::string clouds[2];
  for (int k = 0; k < 2; ++k) {
    const std::string cloud = one.path("cloud" + std::to_string(k) + ".ply");
    const Outcome run = rayfield({"slam", logs[k].bag, "--rig", logs[k].rig, "-o", cloud});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(run.err.find("several echoes of a beam: the first of each is taken") != std::string::npos, k == 1);
    clouds[k] = read_file(cloud);
  }
  EXPECT_NE(clouds[1].find("returns first"), std::string::npos);
  EXPECT_TRUE(clouds[0] == clouds[1]);
  const Outcome info = rayfield({"info", logs[1].bag});
  EXPECT_THAT(info.out, testing::HasSubstr("sensor_msgs/MultiEchoLaserScan"));
  EXPECT_THAT(info.out, testing::HasSubstr("the log has several echoes of a beam"));
}

}  // namespace
}  // namespace rayfield::test
