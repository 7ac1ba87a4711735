#include <gmock/gmock.h>

#include "tests/fault/fault_writer.h"
#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

constexpr int kMostPoints = 2000;

class StoreFault : public ::testing::TestWithParam<const char*> {
 protected:
  // Makes the store ready for the step under test, and a store on which it ran undisturbed.
  void SetUp() override {
    for (const char* step : steps_before(GetParam()))
      ASSERT_EQ(run_writer(folder_.path() / "start", step, "").code, 0) << step;
    copy_start("undisturbed");
    const Outcome outcome = run_writer(folder_.path() / "undisturbed", GetParam(), "");
    ASSERT_EQ(outcome.code, 0) << outcome.message;
    wanted_ = contents(folder_.path() / "undisturbed");
    ASSERT_GT(wanted_.size(), 3U);
  }

  static std::vector<const char*> steps_before(const std::string& step) {
    if (step == "derive") return {"add"};
    if (step == "remove") return {"add", "derive"};
    if (step == "revert") return {"add", "derive", "remove"};
    return {};
  }
  // Steps that publish and write nothing else.
  static bool only_publishes(const std::string& step) { return step == "remove" || step == "revert"; }
  static int fewest_points(const std::string& step) { return only_publishes(step) ? 7 : 15; }

  fs::path copy_start(const std::string& name) {
    const fs::path path = folder_.path() / name;
    fs::remove_all(path);
    if (fs::exists(folder_.path() / "start")) fs::copy(folder_.path() / "start", path, fs::copy_options::recursive);
    return path;
  }

  // After the disturbance: what readers see is whole, the same command succeeds, and the bytes are those wanted.
  void expect_recovery(const fs::path& path, const std::string& fault) {
    if (fs::exists(path / "store.json")) {
      const auto store = Store::open(path);
      ASSERT_TRUE(store) << fault << ": " << store.error().line();
      EXPECT_TRUE(damage_of(*store).empty()) << fault;
    }
    const Outcome again = run_writer(path, GetParam(), "");
    ASSERT_EQ(again.code, 0) << fault << ": " << again.message;
    EXPECT_EQ(contents(path), wanted_) << fault;
    EXPECT_TRUE(damage_of(Store::open(path).value()).empty()) << fault;
  }

  ScratchFolder folder_{quick_folder()};
  std::map<std::string, std::string> wanted_;
};

TEST_P(StoreFault, AKillAtAnyPointIsHealedByTheSameCommand) {
  int points = 0;
  for (int n = 1; n < kMostPoints; ++n) {
    const std::string fault = "*:" + std::to_string(n) + ":kill";
    const fs::path path = copy_start("victim");
    const Outcome outcome = run_writer(path, GetParam(), fault);
    if (!outcome.killed) {
      ASSERT_EQ(outcome.code, 0) << fault << ": " << outcome.message;
      break;
    }
    ++points;
    expect_recovery(path, fault);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(points, fewest_points(GetParam())) << "the writer passes many points";
  EXPECT_LT(points, kMostPoints - 1);
}

TEST_P(StoreFault, AFullDiskAtAnyPointIsAClearErrorAndHealedByTheSameCommand) {
  int points = 0;
  for (int n = 1; n < kMostPoints; ++n) {
    const std::string fault = "*:" + std::to_string(n) + ":enospc";
    const fs::path path = copy_start("victim");
    const Outcome outcome = run_writer(path, GetParam(), fault);
    ASSERT_FALSE(outcome.killed);
    if (outcome.code == 0) break;
    ++points;
    EXPECT_EQ(outcome.code, static_cast<int>(ErrorCode::resources)) << fault << ": " << outcome.message;
    EXPECT_EQ(std::count(outcome.message.begin(), outcome.message.end(), '\n'), 1) << outcome.message;
    EXPECT_THAT(outcome.message, ::testing::HasSubstr("No space left on device"));
    expect_recovery(path, fault);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(points, fewest_points(GetParam()));
}

TEST_P(StoreFault, EveryKindOfPointIsPassed) {
  for (const char* name : {"lock", "create", "allocate", "write", "fsync", "close", "reopen", "rename", "mkdir", "link",
                           "fsync-directory"}) {
    if (only_publishes(GetParam()) && (std::string(name) == "rename" || std::string(name) == "mkdir")) continue;
    const Outcome outcome = run_writer(copy_start("victim"), GetParam(), std::string(name) + ":1:kill");
    EXPECT_TRUE(outcome.killed) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Steps, StoreFault, ::testing::Values("add", "derive", "remove", "revert"));

TEST(StoreFaultLeftovers, TemporaryFilesOfAKilledWriterAreGoneAfterTheNextOne) {
  ScratchFolder folder;
  const fs::path path = folder.path() / "block";
  ASSERT_TRUE(run_writer(path, "add", "fsync:2:kill").killed);
  EXPECT_FALSE(fs::is_empty(path / "tmp"));
  ASSERT_EQ(run_writer(path, "add", "").code, 0);
  EXPECT_TRUE(fs::is_empty(path / "tmp"));
}

TEST(StoreFaultSpill, AWriterThatDiesOrFindsTheDiskFullWhileItPutsRaysAsideIsHealed) {
  ScratchFolder folder;
  ASSERT_EQ(run_writer(folder.path() / "undisturbed", "scatter", "").code, 0);
  const auto wanted = contents(folder.path() / "undisturbed");
  const fs::path path = folder.path() / "victim";
  EXPECT_TRUE(run_writer(path, "scatter", "spill:1:kill").killed);
  const Outcome full = run_writer(path, "scatter", "spill:3:enospc");
  EXPECT_EQ(full.code, static_cast<int>(ErrorCode::resources)) << full.message;
  EXPECT_TRUE(fs::is_empty(path / "tmp"));
  EXPECT_EQ(run_writer(path, "scatter", "").code, 0);
  EXPECT_TRUE(contents(path) == wanted);
}

TEST(StoreFaultLeftovers, GcFreesWhatAKilledWriterLeft) {
  ScratchFolder folder;
  const fs::path path = folder.path() / "block";
  ASSERT_TRUE(run_writer(path, "add", "link:2:kill").killed);
  Store store = Store::open(path).value();
  const auto report = store.gc({});
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_GT(report->bytes_moved, 0U);
  EXPECT_TRUE(fs::is_empty(path / "tmp"));
  EXPECT_TRUE(fs::is_empty(path / "scans"));
  EXPECT_EQ(run_writer(path, "add", "").code, 0);
}

}  // namespace
}  // namespace rayfield::tile::testing
