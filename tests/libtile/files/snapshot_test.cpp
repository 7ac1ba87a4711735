#include "rayfield/tile/snapshot.h"

#include <gtest/gtest.h>

namespace rayfield::tile::testing {
namespace {

TEST(Snapshot, ContentOfATileDependsOnAllItsFiles) {
  TileEntry tile;
  tile.file = {"scans/x/rays/a.h5", 5, "cd"};
  tile.more_files = {{"scans/x/rays/b.h5", 6, "ef"}};
  const std::string both = tile.content_sha256();
  tile.more_files[0].sha256 = "00";
  EXPECT_NE(tile.content_sha256(), both);
  tile.more_files.clear();
  EXPECT_EQ(tile.content_sha256(), tile.file.sha256);
}

}  // namespace
}  // namespace rayfield::tile::testing
