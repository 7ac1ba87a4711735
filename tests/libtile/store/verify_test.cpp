#include <gmock/gmock.h>
#include <sys/resource.h>

#include "tests/libtile/processed_store.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::HasSubstr;

class Verify : public ProcessedStore {};

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

// Hashing it would take an hour.
TEST_F(Verify, AFileThatClaimsATerabyteIsNamedWithoutReadingIt) {
  const std::string path = store_.latest()->scans.at(0).tiles.at(0).file.path;
  std::error_code failed;
  fs::resize_file(store_.folder() / path, std::uintmax_t{1} << 40, failed);
  if (failed) GTEST_SKIP() << "the disk takes no sparse file of a terabyte";
  const auto damage = damage_of(store_);
  ASSERT_EQ(damage.size(), 1U);
  EXPECT_EQ(damage[0].path, path);
  EXPECT_THAT(damage[0].reason, HasSubstr("1099511627776 bytes"));
}

// What is behind a link reads as if it were there, and every command that writes refuses it.
TEST_F(Verify, ALinkInPlaceOfAFolderIsNamed) {
  for (const char* place : {"snapshots", "scans", "registry", "tmp", "trash", "scans/2019-02-11",
                            "scans/2019-02-11/rays", "scans/2019-02-11/ground", "registry/rows"}) {
    const fs::path link = store_.folder() / place, aside = folder_.path() / "aside";
    const bool was_there = fs::exists(link);
    was_there ? fs::rename(link, aside) : static_cast<void>(fs::create_directory(aside));
    fs::create_directory_symlink(aside, link);
    const auto damage = damage_of(store_);
    ASSERT_EQ(damage.size(), 1U) << place;
    EXPECT_EQ(damage[0].path, place);
    EXPECT_THAT(damage[0].reason, HasSubstr("link"));
    fs::remove(link);
    was_there ? fs::rename(aside, link) : static_cast<void>(fs::remove(aside));
  }
  EXPECT_TRUE(damage_of(store_).empty());
}

// As many descriptors as are open always: nothing can be opened, and nothing is known of any file.
TEST_F(Verify, NoFileDescriptorLeftIsNoDamage) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit none_left = before;
  none_left.rlim_cur = 3;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none_left), 0);
  Progress progress;
  const auto latest = store_.latest();
  const auto damage = store_.verify(true, 1, progress);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  ASSERT_FALSE(latest);
  EXPECT_EQ(latest.error().code, ErrorCode::resources) << latest.error().line();
  ASSERT_FALSE(damage);
  EXPECT_EQ(damage.error().code, ErrorCode::resources) << damage.error().line();
}

TEST_F(Verify, ADamagedSnapshotIsAnErrorOfEveryReader) {
  flip_bit(store_.folder() / "snapshots" / "00000002.json", 500);
  const auto latest = store_.latest();
  ASSERT_FALSE(latest);
  EXPECT_EQ(latest.error().code, ErrorCode::damaged);
  EXPECT_THAT(latest.error().line(), HasSubstr("00000002.json"));
  EXPECT_FALSE(store_.gc({})) << "what nothing names cannot be told while a snapshot is unreadable";
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

}  // namespace
}  // namespace rayfield::tile::testing
