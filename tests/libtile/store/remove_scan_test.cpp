#include "libtile/store/remove_scan.h"

#include <gmock/gmock.h>

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> ids(const Snapshot& snapshot) {
  std::vector<std::string> all;
  for (const ScanEntry& scan : snapshot.scans) all.push_back(scan.scan_id);
  return all;
}

class Remove : public ::testing::Test {
 protected:
  void add_scan(const std::string& date, const std::string& name = {}) {
    AddOptions options = add_options(date);
    options.name = name;
    options.inputs[0].sha256 = std::string(64, name.empty() ? 'a' : name[0]);
    ASSERT_TRUE(add(store_, simulated_drive(500, ++seed_), options));
  }
  unsigned seed_ = 0;
  ScratchFolder folder_;
  Store store_ = make_store(folder_.path() / "block");
};

TEST_F(Remove, TakesAScanByItsDateOutOfTheNextSnapshotAndLeavesItsFiles) {
  add_scan("2019-02-11");
  add_scan("2019-03-11");
  const auto before = contents(store_.folder());
  const auto report = store_.remove("2019-02-11", "rayfield remove");
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->scan_id, "2019-02-11");
  EXPECT_EQ(report->snapshot, 3U);
  EXPECT_FALSE(report->already_gone);
  EXPECT_THAT(ids(*store_.latest()), ElementsAre("2019-03-11"));
  EXPECT_EQ(store_.latest()->command, "rayfield remove");
  EXPECT_EQ(ids(*store_.snapshot(2)).size(), 2U) << "the older snapshot still has it";
  auto after = contents(store_.folder());
  EXPECT_EQ(after.erase("snapshots/00000003.json"), 1U);
  EXPECT_EQ(after, before);
  EXPECT_TRUE(store_.gc({})->files.empty()) << "older snapshots name the files";
}

TEST_F(Remove, AnIdNamesOneScanOfADateThatHasSeveral) {
  add_scan("2019-02-11", "morning");
  add_scan("2019-02-11", "evening");
  const auto ambiguous = store_.remove("2019-02-11", "x");
  ASSERT_FALSE(ambiguous);
  EXPECT_EQ(ambiguous.error().code, ErrorCode::usage);
  EXPECT_THAT(ambiguous.error().line(), HasSubstr("2019-02-11_evening, 2019-02-11_morning"));
  EXPECT_EQ(store_.latest()->number, 2U);
  ASSERT_TRUE(store_.remove("2019-02-11_morning", "x"));
  EXPECT_THAT(ids(*store_.latest()), ElementsAre("2019-02-11_evening"));
  ASSERT_TRUE(store_.remove("2019-02-11", "x")) << "one is left of that date";
  EXPECT_TRUE(store_.latest()->scans.empty());
}

TEST_F(Remove, TheSameCommandAgainHasNothingToDo) {
  add_scan("2019-02-11", "evening");
  for (const char* name : {"2019-02-11", "2019-02-11_evening"}) {
    ASSERT_TRUE(store_.remove(name, "x"));
    const auto again = store_.remove(name, "x");
    ASSERT_TRUE(again) << again.error().line();
    EXPECT_TRUE(again->already_gone);
    EXPECT_EQ(again->scan_id, "2019-02-11_evening");
    EXPECT_EQ(again->snapshot, store_.latest()->number);
  }
  EXPECT_EQ(store_.latest()->number, 2U);
}

// `remove 2019-02-11` that is killed after it published and typed again must not take the evening's scan too.
TEST_F(Remove, AnIdThatWasRemovedIsNotTakenForTheDateOfAnotherScan) {
  add_scan("2019-02-11");
  add_scan("2019-02-11", "evening");
  ASSERT_TRUE(store_.remove("2019-02-11", "x"));
  const auto again = store_.remove("2019-02-11", "x");
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_TRUE(again->already_gone);
  EXPECT_THAT(ids(*store_.latest()), ElementsAre("2019-02-11_evening"));
}

TEST_F(Remove, AScanThatNeverWasThereIsAnError) {
  add_scan("2019-02-11");
  for (const char* name : {"2019-02-12", "evening", "", "../2019-02-11"}) {
    const auto removed = store_.remove(name, "x");
    ASSERT_FALSE(removed) << name;
    EXPECT_EQ(removed.error().code, ErrorCode::usage) << name;
  }
  EXPECT_EQ(store_.latest()->number, 1U);
}

TEST_F(Remove, ARemovedScanCanBeAddedAgain) {
  add_scan("2019-02-11");
  const auto files = store_.latest()->scans.at(0).tiles.size();
  ASSERT_TRUE(store_.remove("2019-02-11", "x"));
  seed_ = 0;
  add_scan("2019-02-11");
  EXPECT_EQ(store_.latest()->scans.at(0).tiles.size(), files);
  EXPECT_TRUE(damage_of(store_).empty());
}

TEST_F(Remove, WaitsForNobodyWhileAnotherWriterHoldsTheStore) {
  add_scan("2019-02-11");
  const auto writer = store_.write_derived();
  ASSERT_TRUE(writer);
  EXPECT_EQ(store_.remove("2019-02-11", "x").error().code, ErrorCode::locked);
  EXPECT_EQ(store_.revert(1, "x").error().code, ErrorCode::locked);
}

}  // namespace
}  // namespace rayfield::tile::testing
