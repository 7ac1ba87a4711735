#include "libtile/files/writer_lock.h"

#include <sys/wait.h>
#include <unistd.h>

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

TEST(WriterLock, ASecondWriterIsToldThatTheStoreIsLocked) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  const auto first = store.write_derived();
  ASSERT_TRUE(first);
  EXPECT_EQ(store.write_derived().error().code, ErrorCode::locked);
  EXPECT_EQ(add(store, simulated_drive(10)).error().code, ErrorCode::locked);
  EXPECT_EQ(store.gc({}).error().code, ErrorCode::locked);
  EXPECT_TRUE(store.gc({.dry_run = true})) << "looking needs no lock";
}

TEST(WriterLock, AnotherProcessIsLockedOutUntilTheFirstHasGone) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  int ready[2], done[2];
  ASSERT_EQ(::pipe(ready), 0);
  ASSERT_EQ(::pipe(done), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto writer = store.write_derived();
    char byte = writer ? 'y' : 'n';
    if (::write(ready[1], &byte, 1) != 1) ::_exit(1);
    if (::read(done[0], &byte, 1) != 1) ::_exit(1);
    ::_exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  ASSERT_EQ(byte, 'y');
  EXPECT_EQ(add(store, simulated_drive(10)).error().code, ErrorCode::locked);
  EXPECT_EQ(store.latest()->number, 0U) << "readers never wait";
  ASSERT_EQ(::write(done[1], "x", 1), 1);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(add(store, simulated_drive(10)));
  for (const int fd : {ready[0], ready[1], done[0], done[1]}) ::close(fd);
}

}  // namespace
}  // namespace rayfield::tile::testing
