#include <gmock/gmock.h>

#include "rayfield/core/sha256.h"
#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::HasSubstr;

class Verify : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(add(store_, simulated_drive(20000)));
    auto writer = store_.write_derived();
    ArraySet arrays;
    arrays.kind = "ground";
    arrays.columns["z"] = std::vector<float>(1000, 1.5F);
    const auto entry = writer->put({"2019-02-11", "ground", "block", sha256_hex("k")}, arrays);
    ASSERT_TRUE(writer->set("2019-02-11", {*entry}));
    ASSERT_TRUE(writer->commit("process"));
    ASSERT_TRUE(damage_of(store_).empty());
  }
  ScratchFolder folder_;
  Store store_ = make_store(folder_.path() / "block");
};

TEST_F(Verify, AFlippedBitAnywhereIsFoundAndItsFileNamed) {
  for (const auto& [path, bytes] : contents(store_.folder())) {
    for (const std::size_t offset : {std::size_t{0}, bytes.size() / 2, bytes.size() - 1}) {
      flip_bit(store_.folder() / path, offset);
      const auto damage = damage_of(store_);
      ASSERT_EQ(damage.size(), 1U) << path << " at " << offset;
      EXPECT_EQ(damage[0].path, path);
      EXPECT_FALSE(damage[0].reason.empty());
      write_text(store_.folder() / path, bytes);
    }
  }
  EXPECT_TRUE(damage_of(store_).empty());
}

TEST_F(Verify, MissingAndTruncatedFilesAreNamedWithTheReason) {
  const Snapshot snapshot = *store_.latest();
  const std::string first = snapshot.scans.at(0).tiles.at(0).file.path,
                    second = snapshot.scans[0].tiles.at(1).file.path;
  fs::remove(store_.folder() / first);
  fs::resize_file(store_.folder() / second, 100);
  const auto damage = damage_of(store_, false);
  ASSERT_EQ(damage.size(), 2U);
  std::map<std::string, std::string> reasons;
  for (const Damage& d : damage) reasons[d.path] = d.reason;
  EXPECT_THAT(reasons.at(first), HasSubstr("missing"));
  EXPECT_THAT(reasons.at(second), HasSubstr("100 bytes"));
}

TEST_F(Verify, ADamagedTileIsNotReadAsIfItWereGood) {
  const TileEntry tile = store_.latest()->scans.at(0).tiles.at(0);
  ASSERT_TRUE(store_.open_tile(tile)) << "checked once before, so that a stale check would show";
  flip_bit(store_.folder() / tile.file.path, tile.file.size / 2);
  const auto reader = store_.open_tile(tile);
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().code, ErrorCode::damaged);
  EXPECT_THAT(reader.error().line(), HasSubstr(tile.file.path));
  fs::remove(store_.folder() / tile.file.path);
  EXPECT_EQ(store_.open_tile(tile).error().code, ErrorCode::damaged);
}

TEST_F(Verify, DamagedDerivedDataIsNotReadAsIfItWereGood) {
  const DerivedEntry entry = store_.latest()->scans.at(0).derived.at(0);
  flip_bit(store_.folder() / entry.file.path, entry.file.size / 3);
  EXPECT_EQ(store_.read_derived(entry).error().code, ErrorCode::damaged);
  fs::remove(store_.folder() / entry.file.path);
  EXPECT_EQ(store_.read_derived(entry).error().code, ErrorCode::damaged);
}

TEST_F(Verify, ADamagedSnapshotIsAnErrorOfEveryReader) {
  flip_bit(store_.folder() / "snapshots" / "00000002.json", 500);
  const auto latest = store_.latest();
  ASSERT_FALSE(latest);
  EXPECT_EQ(latest.error().code, ErrorCode::damaged);
  EXPECT_THAT(latest.error().line(), HasSubstr("00000002.json"));
  EXPECT_FALSE(store_.gc(false)) << "what nothing names cannot be told while a snapshot is unreadable";
}

TEST_F(Verify, TheNewestSnapshotAloneIsCheckedUnlessAllAreAskedFor) {
  AddOptions options = add_options();
  options.overwrite = true;
  const std::string old_file = store_.latest()->scans.at(0).tiles.at(0).file.path;
  ASSERT_TRUE(add(store_, simulated_drive(5000, 9), options));
  fs::remove(store_.folder() / old_file);
  EXPECT_TRUE(damage_of(store_, false).empty());
  EXPECT_EQ(damage_of(store_, true).size(), 1U);
}

TEST_F(Verify, GcRemovesWhatNoSnapshotNamesAndNothingElse) {
  const auto before = contents(store_.folder());
  fs::create_directories(store_.folder() / "scans" / "2018-01-01" / "rays");
  write_text(store_.folder() / "scans" / "2018-01-01" / "rays" / "0_0.h5", std::string(1000, 'x'));
  write_text(store_.folder() / "registry" / "stray", std::string(10, 'x'));
  write_text(store_.folder() / "tmp" / "0123.tmp", std::string(100, 'x'));
  EXPECT_EQ(store_.gc(true).value(), 1110U);
  EXPECT_TRUE(fs::exists(store_.folder() / "tmp" / "0123.tmp"));
  EXPECT_EQ(store_.gc(false).value(), 1110U);
  EXPECT_EQ(contents(store_.folder()), before);
  EXPECT_FALSE(fs::exists(store_.folder() / "scans" / "2018-01-01"));
  EXPECT_EQ(store_.gc(false).value(), 0U);
  EXPECT_TRUE(damage_of(store_).empty());
}

}  // namespace
}  // namespace rayfield::tile::testing
