#include <gmock/gmock.h>

#include "tests/libtile/processed_store.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::HasSubstr;

class CheckedFilesTest : public ProcessedStore {};

TEST_F(CheckedFilesTest, ADamagedTileIsNotReadAsIfItWereGood) {
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

TEST_F(CheckedFilesTest, DamagedDerivedDataIsNotReadAsIfItWereGood) {
  const DerivedEntry entry = store_.latest()->scans.at(0).derived.at(0);
  flip_bit(store_.folder() / entry.file.path, entry.file.size / 3);
  EXPECT_EQ(store_.read_derived(entry).error().code, ErrorCode::damaged);
  fs::remove(store_.folder() / entry.file.path);
  EXPECT_EQ(store_.read_derived(entry).error().code, ErrorCode::damaged);
}

}  // namespace
}  // namespace rayfield::tile::testing
