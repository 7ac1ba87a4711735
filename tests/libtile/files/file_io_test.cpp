#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

/// A file system of that size, where the kernel lets this user have one.
class SmallDisk {
 public:
  SmallDisk(const fs::path& where, const std::string& options) : where_(where) {
    fs::create_directories(where);
    mounted_ = ::mount("rayfield-test", where.c_str(), "tmpfs", 0, options.c_str()) == 0;
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    if (mounted_) ::umount2(where_.c_str(), MNT_DETACH);
  }
  bool mounted() const { return mounted_; }
  bool make_read_only() const {
    return ::mount(nullptr, where_.c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr) == 0;
  }
  bool resize(const std::string& options) const {
    return ::mount(nullptr, where_.c_str(), nullptr, MS_REMOUNT, options.c_str()) == 0;
  }

 private:
  fs::path where_;
  bool mounted_ = false;
};

TEST(FileIo, AFullDiskLosesNothingAndTheSameCommandSucceedsWithMoreRoom) {
  ScratchFolder folder;
  const SmallDisk disk(folder.path() / "disk", "size=1m");
  if (!disk.mounted()) GTEST_SKIP() << "no right to mount a small disk here";
  Store store = make_store(folder.path() / "disk" / "block");
  ASSERT_TRUE(add(store, simulated_drive(3000), add_options("2018-12-12")));
  const auto before = contents(store.folder());
  for (const bool knows_count : {true, false}) {
    MemorySource source(scattered_rays(200000, 60));
    source.knows_count = knows_count;
    Progress progress;
    const auto report = store.add(source, add_options(), progress);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::resources) << report.error().line();
    EXPECT_THAT(report.error().line(), ::testing::HasSubstr("free some disk space"));
    EXPECT_EQ(store.latest()->number, 1U);
    EXPECT_TRUE(damage_of(store).empty());
    EXPECT_EQ(contents(store.folder()), before);
  }
  ASSERT_TRUE(disk.resize("size=64m"));
  const auto report = add(store, scattered_rays(200000, 60));
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_TRUE(damage_of(store).empty());
}

TEST(FileIo, AReadOnlyDiskCanBeReadAndRefusesWritersClearly) {
  ScratchFolder folder;
  const SmallDisk disk(folder.path() / "disk", "size=8m");
  if (!disk.mounted()) GTEST_SKIP() << "no right to mount a small disk here";
  ASSERT_TRUE([&] {
    Store writable = make_store(folder.path() / "disk" / "block");
    return add(writable, simulated_drive(3000)).has_value();
  }());
  ASSERT_TRUE(disk.make_read_only());
  Store store = Store::open(folder.path() / "disk" / "block").value();
  EXPECT_TRUE(damage_of(store).empty());
  EXPECT_GT(read_tile(store, store.latest()->scans.at(0).tiles.at(0)).size(), 0U);
  for (const auto& error : {add(store, simulated_drive(100), add_options("2020-01-01")).error(),
                            store.write_derived().error(), store.gc({}).error()}) {
    EXPECT_EQ(error.code, ErrorCode::resources);
    EXPECT_THAT(error.line(), ::testing::HasSubstr("Read-only file system"));
  }
}

TEST(FileIo, AFolderWithoutPermissionRefusesWritersClearly) {
  ScratchFolder folder;
  {
    Store store = make_store(folder.path() / "block");
    ASSERT_TRUE(add(store, simulated_drive(1000)));
  }
  fs::permissions(folder.path(), fs::perms::all);
  // Root may write anywhere: the attempt is made by a child that is nobody.
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (::geteuid() == 0) {
      if (::setgid(65534) != 0 || ::setuid(65534) != 0) ::_exit(77);
    } else {
      for (auto& entry : fs::recursive_directory_iterator(folder.path() / "block"))
        fs::permissions(entry.path(), fs::perms::owner_write, fs::perm_options::remove);
      fs::permissions(folder.path() / "block", fs::perms::owner_write, fs::perm_options::remove);
    }
    auto store = Store::open(folder.path() / "block");
    if (!store) ::_exit(2);
    const auto report = add(*store, simulated_drive(100), add_options("2020-01-01"));
    const bool good = !report && report.error().code == ErrorCode::resources &&
                      report.error().line().find("Permission denied") != std::string::npos;
    ::_exit(good ? 0 : 3);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  for (auto& entry : fs::recursive_directory_iterator(folder.path() / "block"))
    fs::permissions(entry.path(), fs::perms::owner_write, fs::perm_options::add);
  fs::permissions(folder.path() / "block", fs::perms::owner_write, fs::perm_options::add);
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "cannot become another user here";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace rayfield::tile::testing
