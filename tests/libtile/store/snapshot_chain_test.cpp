#include "libtile/store/snapshot_chain.h"

#include <gmock/gmock.h>

#include "libtile/files/writer_lock.h"
#include "libtile/store/snapshot_log.h"
#include "tests/libtile/processed_store.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::HasSubstr;

// Three snapshots: a scan, its derived file, a second scan.
class SnapshotChainTest : public ProcessedStore {
 protected:
  void SetUp() override {
    ProcessedStore::SetUp();
    AddOptions options = add_options("2019-03-01");
    options.attachments = {{"alignment.json", kAlignment}, {"slam.json", "{}"}};
    ASSERT_TRUE(add(store_, simulated_drive(20000, 2), options));
    before_ = contents(store_.folder());
  }
  fs::path snapshot(int number) const { return snapshot_path(store_.folder(), static_cast<std::uint64_t>(number)); }
  void expect_nothing_lost() const {
    for (const auto& [path, bytes] : before_)
      if (path.rfind("snapshots/", 0) != 0) {
        EXPECT_EQ(file_text(store_.folder() / path), bytes) << path;
      }
  }
  RepairReport repair(bool dry_run = false) {
    Progress progress;
    auto report = store_.repair(dry_run, "repair", progress);
    if (!report) throw std::runtime_error(report.error().line());
    return *report;
  }

  static constexpr const char* kAlignment =
      R"({"verdict": "aligned", "pivot_m": [1, 2], "offset_m": [0.5, -0.25, 0.125], "yaw_rad": 0.001,)"
      R"( "landmarks": 7, "residual_m": 0.02})";
  std::map<std::string, std::string> before_;
};

TEST_F(SnapshotChainTest, AStoreKnowsTheNewestSnapshotThatItPublished) {
  EXPECT_EQ(last_published(store_.folder()), 3U);
  ScratchFolder other;
  EXPECT_EQ(last_published(make_store(other.path() / "new").folder()), 0U);
  EXPECT_TRUE(read_chain(store_.folder())->whole());
  write_text(store_.folder() / "lock", "");
  EXPECT_EQ(last_published(store_.folder()), std::nullopt) << "as in stores of earlier versions";
  EXPECT_EQ(store_.latest()->number, 3U);
}

TEST_F(SnapshotChainTest, WithoutItsSnapshotsAStoreIsDamagedAndGcDeletesNothing) {
  for (const bool knows : {true, false}) {
    SCOPED_TRACE(knows ? "the lock file knows" : "a store of an earlier version");
    for (int i = 1; i <= 3; ++i) fs::remove(snapshot(i));
    if (!knows) write_text(store_.folder() / "lock", "");
    EXPECT_FALSE(damage_of(store_, false).empty());
    if (knows) {
      EXPECT_EQ(store_.latest().error().code, ErrorCode::damaged);
    }
    const auto gc = store_.gc({});
    ASSERT_FALSE(gc);
    EXPECT_EQ(gc.error().code, ErrorCode::damaged);
    EXPECT_THAT(gc.error().line(), HasSubstr("rayfield repair"));
    expect_nothing_lost();
  }
}

TEST_F(SnapshotChainTest, TheNewestIsNotSilentlyRevertedFrom) {
  fs::remove(snapshot(3));
  const auto latest = store_.latest();
  ASSERT_FALSE(latest);
  EXPECT_EQ(latest.error().code, ErrorCode::damaged);
  EXPECT_THAT(latest.error().line(), HasSubstr("00000003.json"));
  EXPECT_THAT(latest.error().line(), HasSubstr("the newest that is there is 2"));
  EXPECT_FALSE(add(store_, simulated_drive(100), add_options("2020-01-01"))) << "nothing is built on the older one";
  ASSERT_EQ(damage_of(store_, false).size(), 1U);
  EXPECT_FALSE(store_.gc({}));
  expect_nothing_lost();
}

TEST_F(SnapshotChainTest, AGapInTheMiddleIsFoundByVerifyThoughTheNewestIsRead) {
  fs::remove(snapshot(2));
  EXPECT_EQ(store_.latest()->number, 3U);
  const auto damage = damage_of(store_, false);
  ASSERT_EQ(damage.size(), 1U);
  EXPECT_EQ(damage[0].path, "snapshots/00000002.json");
  EXPECT_THAT(damage[0].reason, HasSubstr("missing"));
  EXPECT_TRUE(store_.gc({})) << "all files are named by what is there";
  expect_nothing_lost();
  fs::remove(snapshot(1));
  EXPECT_THAT(damage_of(store_, false).at(0).reason, HasSubstr("1 to 2"));
}

TEST_F(SnapshotChainTest, ASnapshotOfAnotherHistoryIsFound) {
  Snapshot stray = *store_.latest();
  stray.number = 4, stray.parent = 1;
  ASSERT_TRUE(*publish_as(store_.folder(), "x", stray));
  const auto damage = damage_of(store_, false);
  ASSERT_EQ(damage.size(), 1U);
  EXPECT_THAT(damage[0].reason, HasSubstr("made from snapshot 1, not from 3"));
  const RepairReport report = repair();
  EXPECT_EQ(report.snapshot, 0U) << "nobody but the user knows which history is right";
}

TEST_F(SnapshotChainTest, AWholeHistoryIsLeftAlone) {
  const RepairReport report = repair();
  EXPECT_TRUE(report.found.empty());
  EXPECT_EQ(report.snapshot, 0U);
  EXPECT_EQ(contents(store_.folder()), before_);
}

TEST_F(SnapshotChainTest, RepairMakesTheScanOfALostNewestSnapshotAgainFromItsFiles) {
  const Snapshot whole = *store_.latest();
  const ScanEntry was = *whole.find_scan("2019-03-01");
  fs::remove(snapshot(3));
  EXPECT_EQ(repair(true).rebuilt, std::vector<std::string>{"2019-03-01"});
  EXPECT_FALSE(store_.latest()) << "a dry run changes nothing";
  const RepairReport report = repair();
  EXPECT_EQ(report.snapshot, 4U) << "a number is never given twice";
  EXPECT_TRUE(report.left_out.empty());
  const auto latest = store_.latest();
  ASSERT_TRUE(latest) << latest.error().line();
  EXPECT_EQ(latest->parent, 2U);
  EXPECT_EQ(latest->lost, (std::vector<SnapshotRange>{{3, 3}}));
  const ScanEntry* now = latest->find_scan("2019-03-01");
  ASSERT_NE(now, nullptr);
  EXPECT_EQ(now->ray_count, was.ray_count);
  EXPECT_EQ(now->hit_count, was.hit_count);
  EXPECT_EQ(now->start_time_s, was.start_time_s);
  EXPECT_EQ(now->end_time_s, was.end_time_s);
  EXPECT_TRUE(now->origin_bounds.isApprox(was.origin_bounds, 1e-12));
  ASSERT_EQ(now->tiles.size(), was.tiles.size());
  for (std::size_t i = 0; i < was.tiles.size(); ++i) {
    EXPECT_EQ(now->tiles[i].file.sha256, was.tiles[i].file.sha256);
    EXPECT_EQ(now->tiles[i].segment_count, was.tiles[i].segment_count);
    EXPECT_EQ(now->tiles[i].start_count, was.tiles[i].start_count);
    EXPECT_EQ(now->tiles[i].hit_count, was.tiles[i].hit_count);
  }
  ASSERT_EQ(now->attachments.size(), 2U);
  EXPECT_EQ(*store_.read_attachment(now->attachments[1]), "{}");
  ASSERT_TRUE(now->alignment);
  EXPECT_EQ(now->alignment->verdict, AlignmentVerdict::aligned);
  EXPECT_EQ(now->alignment->offset_m, Eigen::Vector3d(0.5, -0.25, 0.125));
  EXPECT_TRUE(damage_of(store_).empty());
  ASSERT_TRUE(add(store_, simulated_drive(3000, 3), add_options("2019-04-01")));
  EXPECT_TRUE(damage_of(store_).empty()) << "what was lost stays on record";
  expect_nothing_lost();
}

TEST_F(SnapshotChainTest, RepairGoesOnWithoutASingleSnapshot) {
  for (const bool knows : {true, false}) {
    const std::vector<std::uint64_t> numbers = *snapshot_numbers(store_.folder());
    for (const std::uint64_t number : numbers) fs::remove(snapshot_path(store_.folder(), number));
    if (!knows) write_text(store_.folder() / "lock", "");
    const RepairReport report = repair();
    EXPECT_EQ(report.rebuilt, (std::vector<std::string>{"2019-02-11", "2019-03-01"}));
    EXPECT_EQ(store_.latest()->scans.size(), 2U);
    EXPECT_TRUE(damage_of(store_).empty());
    expect_nothing_lost();
  }
}

TEST_F(SnapshotChainTest, RepairLeavesOutAScanOfWhichTilesAreMissing) {
  const std::string tile = store_.latest()->find_scan("2019-03-01")->tiles.front().file.path;
  fs::remove(snapshot(3));
  fs::remove(store_.folder() / tile);
  const RepairReport report = repair();
  EXPECT_TRUE(report.rebuilt.empty());
  ASSERT_EQ(report.left_out.size(), 1U);
  EXPECT_EQ(report.left_out[0].path, "scans/2019-03-01");
  EXPECT_THAT(report.left_out[0].reason, HasSubstr("tiles are missing"));
  EXPECT_EQ(store_.latest()->scans.size(), 1U);
}

TEST_F(SnapshotChainTest, RepairPutsAnUnreadableSnapshotAsideAndAScanThatWasRemovedStaysRemoved) {
  ASSERT_TRUE(store_.remove("2019-02-11", "remove"));
  flip_bit(snapshot(4), 500);
  const RepairReport report = repair();
  EXPECT_EQ(report.snapshot, 5U);
  EXPECT_TRUE(fs::exists(store_.folder() / "trash" / "snapshots" / "00000004.json"));
  EXPECT_EQ(store_.latest()->scans.size(), 2U) << "back to what snapshot 3 held";
  EXPECT_TRUE(damage_of(store_).empty());
  expect_nothing_lost();
}

}  // namespace
}  // namespace rayfield::tile::testing
