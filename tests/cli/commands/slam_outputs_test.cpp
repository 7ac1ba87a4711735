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

}  // namespace
}  // namespace rayfield::test
