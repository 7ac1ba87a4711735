#include <dlfcn.h>
#include <gtest/gtest.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>

#include "rayfield/formats/geopackage.h"
#include "tests/formats/products_support.h"

namespace {

/// How many more reads of SQLite succeed; below 0: all.
int reads_left = -1;
int reads = 0;

}  // namespace

// Takes the place of the system's, which SQLite reads with: a disk that fails from some read on.
extern "C" ssize_t pread64(int descriptor, void* bytes, size_t count, off64_t offset) {
  static const auto kReal = reinterpret_cast<ssize_t (*)(int, void*, size_t, off64_t)>(::dlsym(RTLD_NEXT, "pread64"));
  ++reads;
  if (reads_left == 0) return errno = EIO, -1;
  if (reads_left > 0) --reads_left;
  return kReal(descriptor, bytes, count, offset);
}

namespace rayfield::formats {
namespace {

using testing::make_block;

// SQLite calls what it cannot read a malformed database, but it has just written it itself.
TEST(GeoPackageDisk, AFileThatCannotBeReadBackIsAMatterOfResources) {
  const testing::TemporaryFolder folder;
  const BlockProducts block = make_block(2, 3, {"2018-12-12", "2019-02-11"});
  reads = 0;
  ASSERT_TRUE(write_geopackage(block, folder / "whole.gpkg"));
  const int all = reads;
  ASSERT_GT(all, 5);
  int failed = 0;
  for (int from = 0; from < all; from += from < 80 ? 1 : 2) {
    reads_left = from;
    const Result<void> written = write_geopackage(block, folder / "a.gpkg");
    reads_left = -1;
    if (written) {  // SQLite could do without, or read it again
      EXPECT_EQ(testing::read_file(folder / "a.gpkg"), testing::read_file(folder / "whole.gpkg")) << from;
      continue;
    }
    ++failed;
    EXPECT_EQ(written.error().code, ErrorCode::resources) << from << ": " << written.error().line();
  }
  EXPECT_GT(failed, 5);
}

}  // namespace
}  // namespace rayfield::formats
