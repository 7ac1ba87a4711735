#include "libtile/hdf5/h5_read.h"

#include <gmock/gmock.h>
#include <hdf5.h>

#include "libtile/hdf5/array_image.h"
#include "rayfield/core/sha256.h"

namespace rayfield::tile::testing {
namespace {

// Builds an HDF5 file with a column that is not data but a link, as no rayfield writes it.
std::vector<std::byte> image_with_link(bool external) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, 4096, false);
  const hid_t file = H5Fcreate("link", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  const hid_t group = H5Gcreate2(file, "columns", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (external) {
    H5Lcreate_external("/etc/passwd", "/x", group, "v", H5P_DEFAULT, H5P_DEFAULT);
  } else {
    H5Lcreate_soft("/attributes", group, "v", H5P_DEFAULT, H5P_DEFAULT);
  }
  const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  const std::string text = R"({"format":"rayfield-arrays","version":1,"kind":"k","kind_version":1,"attributes":"{}"})";
  H5Tset_size(type, text.size());
  const hid_t dataset = H5Dcreate2(file, "attributes", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data());
  H5Dclose(dataset), H5Sclose(space), H5Tclose(type), H5Gclose(group);
  H5Fflush(file, H5F_SCOPE_GLOBAL);
  std::vector<std::byte> image(static_cast<std::size_t>(H5Fget_file_image(file, nullptr, 0)));
  H5Fget_file_image(file, image.data(), image.size());
  H5Fclose(file), H5Pclose(access);
  const std::string seal = "RAYFIELD-SHA256 " + sha256_hex(image);
  for (const char c : seal) image.push_back(static_cast<std::byte>(c));
  return image;
}

TEST(H5Read, LinksInForeignFilesAreNotFollowed) {
  for (const bool external : {false, true}) {
    const auto arrays = decode_arrays(image_with_link(external), "foreign.h5");
    ASSERT_FALSE(arrays);
    EXPECT_EQ(arrays.error().code, ErrorCode::damaged);
    EXPECT_THAT(arrays.error().line(), ::testing::HasSubstr("link"));
  }
}

}  // namespace
}  // namespace rayfield::tile::testing
