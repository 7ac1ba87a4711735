#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>

#include "rayfield/core/file.h"
#include "tests/libtile/processed_store.h"

namespace rayfield::tile::testing {
namespace {

class Garbage : public ProcessedStore {};

const std::string kDigest = "0123456789abcdef";

// What gc frees, and what it moves to the trash.
std::pair<std::uint64_t, std::uint64_t> gc(Store& store, const GarbageOptions& options = {}) {
  const auto report = store.gc(options);
  if (!report) throw std::runtime_error(report.error().line());
  return {report->bytes_removed, report->bytes_moved};
}
using Bytes = std::pair<std::uint64_t, std::uint64_t>;

TEST_F(Garbage, GcDeletesWhatCanBeMadeAnewAndMovesTheRestToTheTrash) {
  const auto before = contents(store_.folder());
  const fs::path scan = store_.folder() / "scans" / "2018-01-01";
  fs::create_directories(scan / "rays");
  fs::create_directories(scan / "ground");
  write_text(scan / "rays" / ("0_-3." + kDigest + ".h5"), std::string(1000, 'x'));
  write_text(scan / "ground" / ("block." + kDigest + "." + kDigest + ".h5"), std::string(10, 'x'));
  write_text(store_.folder() / "tmp" / (kDigest + kDigest + ".tmp"), std::string(100, 'x'));
  EXPECT_EQ(gc(store_, {.dry_run = true}), (Bytes{110, 1000}));
  EXPECT_TRUE(fs::exists(store_.folder() / "tmp" / (kDigest + kDigest + ".tmp")));
  EXPECT_EQ(gc(store_), (Bytes{110, 1000}));
  EXPECT_FALSE(fs::exists(scan));
  const fs::path moved = store_.folder() / "trash" / "scans" / "2018-01-01" / "rays" / ("0_-3." + kDigest + ".h5");
  EXPECT_EQ(file_text(moved), std::string(1000, 'x'));
  EXPECT_EQ(gc(store_), (Bytes{0, 0})) << "the trash stays until it is to be emptied";
  EXPECT_TRUE(fs::exists(moved));
  EXPECT_EQ(gc(store_, {.empty_trash = true}), (Bytes{1000, 0}));
  EXPECT_EQ(contents(store_.folder()), before);
  EXPECT_FALSE(fs::exists(store_.folder() / "trash"));
  EXPECT_TRUE(damage_of(store_).empty());
}

TEST_F(Garbage, GcLeavesWhatBearsNoNameOfOursAndSaysSo) {
  const std::vector<std::string> foreign{"registry/stray",  "scans/2018-01-01/rays/0_0.h5",
                                         "scans/notes.txt", "scans/a/b/c/deep." + kDigest + ".h5",
                                         "tmp/0123.tmp",    "tmp/notes"};
  for (const std::string& path : foreign) {
    fs::create_directories((store_.folder() / path).parent_path());
    write_text(store_.folder() / path, "mine");
  }
  const auto report = store_.gc({});
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_TRUE(report->files.empty());
  for (const std::string& path : foreign) EXPECT_EQ(file_text(store_.folder() / path), "mine") << path;
  EXPECT_THAT(report->foreign,
              ::testing::UnorderedElementsAre("registry/stray", "scans/2018-01-01/rays/0_0.h5", "scans/notes.txt",
                                              "scans/a/b/c", "tmp/0123.tmp", "tmp/notes"));
}

// A stranger's store may have links where its folders belong: what they lead to is not the store's.
TEST_F(Garbage, NothingIsTouchedThroughALink) {
  const fs::path outside = folder_.path() / "outside";
  const std::string tile = "0_0." + kDigest + ".h5", temporary = kDigest + kDigest + ".tmp";
  fs::create_directories(outside / "rays");
  const auto fill = [&] {
    write_text(outside / "rays" / tile, "precious");
    write_text(outside / temporary, "precious");
  };
  const auto untouched = [&] {
    return file_text(outside / "rays" / tile) == "precious" && file_text(outside / temporary) == "precious";
  };
  for (const char* place :
       {"scans", "registry", "tmp", "trash", "scans/2018-01-01", "scans/2019-02-11/rays", "registry/rows"}) {
    fill();
    const fs::path link = store_.folder() / place, aside = folder_.path() / "aside";
    const bool was_there = fs::exists(link);
    if (was_there) fs::rename(link, aside);
    fs::create_directory_symlink(outside, link);
    for (const GarbageOptions& options : {GarbageOptions{.dry_run = true}, GarbageOptions{.empty_trash = true}}) {
      const auto report = store_.gc(options);
      ASSERT_FALSE(report) << place;
      EXPECT_EQ(report.error().code, ErrorCode::damaged) << place;
      EXPECT_THAT(report.error().line(), ::testing::HasSubstr(place));
    }
    const auto added = add(store_, simulated_drive(3000, 4), add_options("2019-03-01"));
    if (link.parent_path() == store_.folder()) {
      ASSERT_FALSE(added) << place;
      EXPECT_EQ(added.error().code, ErrorCode::damaged) << added.error().line();
    }
    EXPECT_TRUE(untouched()) << place;
    EXPECT_EQ(std::distance(fs::recursive_directory_iterator(outside), fs::recursive_directory_iterator()), 3) << place;
    fs::remove(link);
    if (was_there) fs::rename(aside, link);
    if (added) {
      ASSERT_TRUE(store_.remove("2019-03-01", "remove"));
    }
  }
}

// Links inside of what is ours to delete go themselves; what they lead to stays.
TEST_F(Garbage, ScratchAndTrashAreClearedWithoutFollowingLinks) {
  const fs::path outside = folder_.path() / "outside";
  fs::create_directories(outside);
  write_text(outside / "file", "precious");
  for (const char* place : {"tmp/align.abcdef", "trash"}) {
    fs::create_directories(store_.folder() / place);
    fs::create_directory_symlink(outside, store_.folder() / place / "link");
    fs::create_symlink(outside / "file", store_.folder() / place / "file");
  }
  ASSERT_TRUE(store_.gc({.empty_trash = true}));
  EXPECT_FALSE(fs::exists(store_.folder() / "tmp" / "align.abcdef"));
  EXPECT_FALSE(fs::exists(store_.folder() / "trash"));
  EXPECT_EQ(file_text(outside / "file"), "precious");
}

TEST_F(Garbage, GcLeavesScratchThatARunningProgramHolds) {
  for (const char* name : {"align.heldXX", "align.leftXX"}) {
    fs::create_directories(store_.folder() / "tmp" / name / "tiles");
    write_text(store_.folder() / "tmp" / name / "tiles" / "0_0.h5", std::string(100, 'x'));
  }
  FileDescriptor held(::open((store_.folder() / "tmp" / "align.heldXX").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  ASSERT_EQ(::flock(held.get(), LOCK_EX | LOCK_NB), 0);
  EXPECT_EQ(gc(store_, {.dry_run = true}), (Bytes{100, 0}));
  EXPECT_EQ(gc(store_), (Bytes{100, 0}));
  EXPECT_TRUE(fs::exists(store_.folder() / "tmp" / "align.heldXX" / "tiles" / "0_0.h5"));
  EXPECT_FALSE(fs::exists(store_.folder() / "tmp" / "align.leftXX"));
  held.close();  // as the kernel does when the program ends
  EXPECT_EQ(gc(store_), (Bytes{100, 0}));
  EXPECT_FALSE(fs::exists(store_.folder() / "tmp" / "align.heldXX"));
}

}  // namespace
}  // namespace rayfield::tile::testing
