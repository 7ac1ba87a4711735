#include "libtile/tile_file/tile_file.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

TEST(TileFile, ATileFileIsAnOrdinaryHdf5FileWithNamedColumns) {
  ScratchFolder folder;
  Store store = make_store(folder.path() / "block");
  ASSERT_TRUE(add(store, simulated_drive(1000)));
  const TileEntry tile = store.latest()->scans.at(0).tiles.at(0);
  const hid_t file = H5Fopen((store.folder() / tile.file.path).c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  for (const char* name : {"columns/origin_x", "columns/origin_y", "columns/origin_z", "columns/ray_x", "columns/ray_y",
                           "columns/ray_z", "columns/time", "columns/intensity", "columns/flags"}) {
    const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
    ASSERT_GE(dataset, 0) << name;
    const hid_t space = H5Dget_space(dataset);
    EXPECT_EQ(H5Sget_simple_extent_npoints(space), static_cast<hssize_t>(tile.segment_count)) << name;
    H5Sclose(space), H5Dclose(dataset);
  }
  H5Fclose(file);
}

}  // namespace
}  // namespace rayfield::tile::testing
