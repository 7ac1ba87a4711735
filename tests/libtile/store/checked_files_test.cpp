#include <gmock/gmock.h>
#include <sys/stat.h>

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

// Also one of the very size that the file had.
TEST_F(CheckedFilesTest, AFolderInPlaceOfAFileIsDamage) {
  const ScanEntry scan = store_.latest()->scans.at(0);
  TileEntry tile = scan.tiles.at(0);
  DerivedEntry derived = scan.derived.at(0);
  for (FileEntry* file : {&tile.file, &derived.file}) {
    fs::remove(store_.folder() / file->path);
    fs::create_directory(store_.folder() / file->path);
  }
  struct stat status {};
  ASSERT_EQ(::stat((store_.folder() / tile.file.path).c_str(), &status), 0);
  for (const std::uint64_t size : {tile.file.size, static_cast<std::uint64_t>(status.st_size)}) {
    tile.file.size = derived.file.size = size;
    for (const Error& error :
         {store_.open_tile(tile).error(), store_.open_derived(derived).error(), store_.read_derived(derived).error()}) {
      EXPECT_EQ(error.code, ErrorCode::damaged) << error.line();
      EXPECT_THAT(error.line(), HasSubstr("verify")) << error.line();
    }
  }
}

TEST_F(CheckedFilesTest, AFileInPlaceOfAFolderIsDamage) {
  const DerivedEntry entry = store_.latest()->scans.at(0).derived.at(0);
  const fs::path folder = (store_.folder() / entry.file.path).parent_path();
  fs::remove_all(folder);
  write_text(folder, "not a folder");
  EXPECT_EQ(store_.read_derived(entry).error().code, ErrorCode::damaged);
  EXPECT_EQ(store_.open_derived(entry).error().code, ErrorCode::damaged);
}

}  // namespace
}  // namespace rayfield::tile::testing
