#include "libtile/hdf5/h5_dataset.h"

#include <gmock/gmock.h>

#include <array>
#include <cstring>

#include "libtile/hdf5/column_codec.h"
#include "libtile/hdf5/h5_write.h"
#include "tests/libtile/hdf5/h5_reference.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Bytes = std::vector<std::byte>;

void expect_column_refused(const char* what, const char* why, const std::function<void(hid_t)>& column) {
  ForeignSteps steps;
  steps.column = column;
  expect_refused(what, steps.image(), why);
}

TEST(H5Dataset, ColumnsOfOtherFormsAreRefused) {
  const auto changed = [](const std::function<void(hid_t)>& change) {
    return [change](hid_t group) { make_column(group, "v", H5T_STD_U32LE, change); };
  };
  const auto blosc = [](hid_t creation) { H5Pset_filter(creation, kBloscFilter, H5Z_FLAG_OPTIONAL, 0, nullptr); };
  expect_column_refused("in one piece", "not stored as", changed([](hid_t p) { H5Pset_layout(p, H5D_CONTIGUOUS); }));
  expect_column_refused("compact", "not stored as", changed([](hid_t p) { H5Pset_layout(p, H5D_COMPACT); }));
  expect_column_refused("no filter", "not stored as", changed([](hid_t) {}));
  expect_column_refused("another filter", "not stored as", changed([](hid_t p) { H5Pset_deflate(p, 1); }));
  expect_column_refused("two filters", "not stored as", changed([&](hid_t p) { H5Pset_shuffle(p), blosc(p); }));
  expect_column_refused("stored elsewhere", "kind 0x07", changed([](hid_t p) {
                          H5Pset_layout(p, H5D_CONTIGUOUS);
                          H5Pset_external(p, "/etc/passwd", 0, 16);
                        }));
  expect_column_refused("object times", "kind 0x12",
                        changed([&](hid_t p) { blosc(p), H5Pset_obj_track_times(p, true); }));
  for (const hid_t type : {H5T_STD_U32BE, H5T_STD_I8LE, H5T_STD_I16LE, H5T_STD_B32LE, H5T_IEEE_F64BE, H5T_C_S1})
    expect_column_refused("another type", "not a list of numbers", [&](hid_t group) { make_column(group, "v", type); });
  expect_column_refused("a group", "kind 0x11",
                        [](hid_t group) { H5Gclose(H5Gcreate2(group, "v", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)); });
  expect_column_refused("an attribute", "kind 0x0c", [](hid_t group) {
    make_column(group, "v", H5T_STD_U32LE);
    const hid_t column = H5Dopen2(group, "v", H5P_DEFAULT), space = H5Screate(H5S_SCALAR);
    H5Aclose(H5Acreate2(column, "a", H5T_STD_U32LE, space, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space), H5Dclose(column);
  });
  expect_column_refused("a shared type", "a message of an object's header", [](hid_t group) {
    const hid_t type = H5Tcopy(H5T_STD_U32LE);
    H5Tcommit_anon(group, type, H5P_DEFAULT, H5P_DEFAULT);
    make_column(group, "v", type);
    H5Tclose(type);
  });
}

TEST(H5Dataset, ColumnsOfOtherShapesAreRefused) {
  for (const bool unlimited : {false, true}) {
    expect_column_refused(unlimited ? "without a limit" : "two dimensions", "not a list of numbers", [&](hid_t group) {
      const std::array<hsize_t, 2> size = {4, 4}, most = {H5S_UNLIMITED, 4};
      const int rank = unlimited ? 1 : 2;
      const hid_t space = H5Screate_simple(rank, size.data(), unlimited ? most.data() : nullptr);
      const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
      H5Pset_obj_track_times(creation, false), H5Pset_chunk(creation, rank, size.data());
      H5Pset_filter(creation, kBloscFilter, H5Z_FLAG_OPTIONAL, 0, nullptr);
      H5Dclose(H5Dcreate2(group, "v", H5T_STD_U32LE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
      H5Pclose(creation), H5Sclose(space);
    });
  }
  expect_column_refused("a chunk that was never written", "lacks chunks", [](hid_t group) {
    const hsize_t count = 4;
    const hid_t space = H5Screate_simple(1, &count, nullptr), creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_obj_track_times(creation, false), H5Pset_chunk(creation, 1, &count);
    H5Pset_filter(creation, kBloscFilter, H5Z_FLAG_OPTIONAL, 0, nullptr);
    H5Dclose(H5Dcreate2(group, "v", H5T_STD_U32LE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
    H5Pclose(creation), H5Sclose(space);
  });
}

// A column of 40 numbers in ten chunks, and the places of what a stranger might change.
struct SealedColumn {
  Bytes image;
  std::size_t count, layout, first_key;

  SealedColumn() {
    Bytes blob;
    compress(Bytes(4), 1, blob);
    image = build_image("{}", {{"v", ElementType::u8, 40, 4, Chunks(10, blob)}}).value();
    // The last dataspace and layout are those of the column; "TREE" is found after those of both groups.
    first_key = place_of(image, "TREE", 2) + 24;
    layout = place_of(image, std::string_view("\x03\x02\x02", 3), 0);
    count = place_of(image, std::string_view("\x28\0\0\0\0\0\0\0\x28\0\0\0\0\0\0\0", 16), 0);
  }
  using Chunks = std::vector<std::span<const std::byte>>;
};

template <class T>
void expect_claim_refused(std::size_t SealedColumn::*what, std::size_t offset, T claim, const char* why) {
  SealedColumn column;
  put(column.image, column.*what + offset, claim);
  const auto layout = read_layout(resealed(unsealed(column.image)), "claim");
  ASSERT_FALSE(layout) << why << ' ' << claim;
  EXPECT_EQ(layout.error().code, ErrorCode::damaged);
  EXPECT_THAT(layout.error().line(), AllOf(HasSubstr("claim at byte "), HasSubstr(why)));
}

TEST(H5Dataset, ALengthThatTheChunksDoNotBearOutIsRefused) {
  ASSERT_TRUE(read_layout(resealed(unsealed(SealedColumn().image)), "sound"));
  for (const std::uint64_t claim : {std::uint64_t{41}, std::uint64_t{1} << 40U, ~std::uint64_t{0}}) {
    SealedColumn column;
    put(column.image, column.count, claim);
    put(column.image, column.count + 8, claim);
    const auto layout = read_layout(resealed(unsealed(column.image)), "claim");
    ASSERT_FALSE(layout);
    EXPECT_THAT(layout.error().line(), HasSubstr("lacks chunks"));
  }
  expect_claim_refused(&SealedColumn::count, 0, std::uint64_t{36}, "not a list of numbers");
}

TEST(H5Dataset, ChunksOfNoneOrTooManyElementsAreRefused) {
  for (const std::uint32_t claim : {0U, 131073U, ~0U})
    expect_claim_refused(&SealedColumn::layout, 11, claim, "not stored as rayfield stores it");
  for (const std::uint32_t claim : {0U, 2U, ~0U})
    expect_claim_refused(&SealedColumn::layout, 15, claim, "not stored as rayfield stores it");
  expect_claim_refused(&SealedColumn::layout, 11, 8U, "out of place");
}

TEST(H5Dataset, ChunksOutsideOfTheFileOrOfOneAnotherAreRefused) {
  const std::uint64_t size = SealedColumn().image.size() - 80;
  for (const std::uint64_t claim : {size, size - 1, ~std::uint64_t{0}, ~std::uint64_t{15}})
    expect_claim_refused(&SealedColumn::first_key, 24, claim, "cannot hold");
  for (const std::uint32_t claim : {0U, 15U, static_cast<std::uint32_t>(size), ~0U})
    expect_claim_refused(&SealedColumn::first_key, 0, claim, "cannot hold");
  expect_claim_refused(&SealedColumn::first_key, 4, 1U, "cannot hold");
  for (const std::uint64_t claim : {std::uint64_t{1}, std::uint64_t{4}, ~std::uint64_t{3}})
    expect_claim_refused(&SealedColumn::first_key, 8, claim, "out of place");
  expect_claim_refused(&SealedColumn::first_key, 16, std::uint64_t{1}, "out of place");
  SealedColumn column;  // the second chunk leads where the first one does
  std::uint64_t first = 0;
  std::memcpy(&first, column.image.data() + column.first_key + 24, sizeof(first));
  expect_claim_refused(&SealedColumn::first_key, 32 + 24, first, "share bytes");
}

}  // namespace
}  // namespace rayfield::tile::testing
