#include <fcntl.h>
#include <sys/file.h>

#include "rayfield/core/file.h"
#include "tests/libtile/processed_store.h"

namespace rayfield::tile::testing {
namespace {

class Garbage : public ProcessedStore {};

TEST_F(Garbage, GcRemovesWhatNoSnapshotNamesAndNothingElse) {
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

TEST_F(Garbage, GcLeavesScratchThatARunningProgramHolds) {
  for (const char* name : {"align.held", "align.left"}) {
    fs::create_directories(store_.folder() / "tmp" / name / "tiles");
    write_text(store_.folder() / "tmp" / name / "tiles" / "0_0.h5", std::string(100, 'x'));
  }
  FileDescriptor held(::open((store_.folder() / "tmp" / "align.held").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  ASSERT_EQ(::flock(held.get(), LOCK_EX | LOCK_NB), 0);
  EXPECT_EQ(store_.gc(true).value(), 100U);
  EXPECT_EQ(store_.gc(false).value(), 100U);
  EXPECT_TRUE(fs::exists(store_.folder() / "tmp" / "align.held" / "tiles" / "0_0.h5"));
  EXPECT_FALSE(fs::exists(store_.folder() / "tmp" / "align.left"));
  held.close();  // as the kernel does when the program ends
  EXPECT_EQ(store_.gc(false).value(), 100U);
  EXPECT_FALSE(fs::exists(store_.folder() / "tmp" / "align.held"));
}

}  // namespace
}  // namespace rayfield::tile::testing
