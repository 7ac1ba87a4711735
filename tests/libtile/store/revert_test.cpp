#include "libtile/store/revert.h"

#include <gmock/gmock.h>

#include "libtile/store/snapshot_json.h"
#include "tests/libtile/processed_store.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Snapshot 1: a scan; 2: something derived from it.
class Revert : public ProcessedStore {
 protected:
  nlohmann::ordered_json content(std::uint64_t number) const {
    const auto json = to_json(*store_.snapshot(number));
    return {json.at("scans"), json.at("registry")};
  }
};

TEST_F(Revert, PublishesTheContentOfTheOldSnapshotAsANewOne) {
  AddOptions options = add_options();
  options.overwrite = true;
  ASSERT_TRUE(add(store_, simulated_drive(5000, 9), options));
  ASSERT_TRUE(store_.remove("2019-02-11", "x"));
  const auto report = store_.revert(2, "rayfield revert");
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->snapshot, 5U);
  EXPECT_FALSE(report->already_there);
  EXPECT_THAT(report->scans, ElementsAre("2019-02-11"));
  const Snapshot latest = *store_.latest();
  EXPECT_EQ(latest.number, 5U);
  EXPECT_EQ(latest.parent, 4U);
  EXPECT_EQ(latest.command, "rayfield revert");
  EXPECT_EQ(content(5), content(2));
  EXPECT_EQ(store_.history()->size(), 5U) << "nothing is deleted, so that a revert can be reverted";
  EXPECT_TRUE(damage_of(store_).empty());
  ASSERT_TRUE(store_.revert(3, "x"));
  EXPECT_EQ(content(6), content(3));
}

TEST_F(Revert, TheSameCommandAgainHasNothingToDo) {
  ASSERT_TRUE(store_.revert(1, "x"));
  const auto again = store_.revert(1, "x");
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->already_there);
  EXPECT_EQ(again->snapshot, 3U);
  EXPECT_EQ(store_.latest()->number, 3U);
  EXPECT_TRUE(store_.revert(3, "x")->already_there) << "the newest one";
}

TEST_F(Revert, RefusesASnapshotWhoseFilesAreGoneAndNamesThem) {
  const Snapshot old = *store_.snapshot(2);
  ASSERT_TRUE(store_.remove("2019-02-11", "x"));
  const std::string tile = old.scans.at(0).tiles.at(0).file.path, ground = old.scans[0].derived.at(0).file.path;
  fs::remove(store_.folder() / tile);
  fs::resize_file(store_.folder() / ground, 10);
  const auto reverted = store_.revert(2, "x");
  ASSERT_FALSE(reverted);
  EXPECT_EQ(reverted.error().code, ErrorCode::damaged);
  EXPECT_THAT(reverted.error().line(), HasSubstr(tile));
  EXPECT_THAT(reverted.error().line(), HasSubstr(ground));
  EXPECT_THAT(reverted.error().line(), HasSubstr("2 of its files are gone"));
  EXPECT_EQ(store_.latest()->number, 3U);
}

TEST_F(Revert, ASnapshotThatIsNotThereIsNamedWithThoseThatAre) {
  for (const std::uint64_t number : {0U, 3U, 99999U}) {
    const auto reverted = store_.revert(number, "x");
    ASSERT_FALSE(reverted) << number;
    EXPECT_EQ(reverted.error().code, ErrorCode::usage);
    EXPECT_THAT(reverted.error().line(), HasSubstr("1 to 2"));
    EXPECT_EQ(store_.snapshot(number).error().code, ErrorCode::usage);
  }
  const Store empty = make_store(folder_.path() / "empty");
  EXPECT_THAT(empty.snapshot(1).error().line(), HasSubstr("none yet"));
}

}  // namespace
}  // namespace rayfield::tile::testing
