#include <gmock/gmock.h>

#include <limits>

#include "libtile/hdf5/array_image.h"
#include "tests/libtile/store_support.h"

namespace rayfield::tile::testing {
namespace {

ArraySet sample() {
  ArraySet arrays;
  arrays.kind = "voxels";
  arrays.version = 3;
  arrays.attributes = R"({"voxel_m": 0.12, "text": "µ"})";
  arrays.columns["u8"] = std::vector<std::uint8_t>{0, 255, 3};
  arrays.columns["u16"] = std::vector<std::uint16_t>{65535, 0};
  arrays.columns["i32"] = std::vector<std::int32_t>{-2147483647 - 1, 5};
  arrays.columns["u32"] = std::vector<std::uint32_t>{4294967295U};
  arrays.columns["i64"] = std::vector<std::int64_t>{std::numeric_limits<std::int64_t>::min(), -1, 1};
  arrays.columns["f32"] = std::vector<float>{std::numeric_limits<float>::infinity(), -0.0F};
  arrays.columns["f64"] = std::vector<double>{0.1, -1e300, 5e-324};
  arrays.columns["empty"] = std::vector<double>{};
  std::vector<double> many(300001);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = std::sqrt(static_cast<double>(i));
  arrays.columns["many"] = many;
  return arrays;
}

TEST(Arrays, EveryTypeAndLengthComesBackBitForBit) {
  const ArraySet arrays = sample();
  const auto image = encode_arrays(arrays);
  ASSERT_TRUE(image) << image.error().line();
  const auto back = decode_arrays(*image, "x");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->kind, arrays.kind);
  EXPECT_EQ(back->version, arrays.version);
  EXPECT_EQ(back->attributes, arrays.attributes);
  EXPECT_EQ(back->columns, arrays.columns);
}

TEST(Arrays, NanIsKept) {
  ArraySet arrays;
  arrays.kind = "ground";
  arrays.columns["z"] = std::vector<float>{1.0F, std::numeric_limits<float>::quiet_NaN()};
  const auto back = decode_arrays(*encode_arrays(arrays), "x");
  ASSERT_TRUE(back);
  EXPECT_TRUE(std::isnan((*back->column<float>("z"))[1]));
}

TEST(Arrays, ASetWithoutColumnsIsASet) {
  ArraySet arrays;
  arrays.kind = "rows";
  arrays.attributes = "{}";
  const auto back = decode_arrays(*encode_arrays(arrays), "x");
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_TRUE(back->columns.empty());
}

TEST(Arrays, EqualContentGivesEqualBytes) {
  const ArraySet arrays = sample();
  const auto first = encode_arrays(arrays);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(*encode_arrays(arrays), *first);
}

TEST(Arrays, LongAttributesAreKept) {
  ArraySet arrays;
  arrays.kind = "rows";
  arrays.attributes = "\"" + std::string(1 << 20, 'x') + "\"";
  EXPECT_EQ(decode_arrays(*encode_arrays(arrays), "x")->attributes, arrays.attributes);
}

TEST(Arrays, AnyFlippedBitIsFound) {
  ArraySet arrays = sample();
  arrays.columns.erase("many");
  const std::vector<std::byte> image = *encode_arrays(arrays);
  for (std::size_t i = 0; i < image.size(); i += 7) {
    std::vector<std::byte> bad = image;
    bad[i] ^= std::byte{16};
    const auto back = decode_arrays(bad, "tile.h5");
    ASSERT_FALSE(back) << "byte " << i;
    EXPECT_EQ(back.error().code, ErrorCode::damaged);
    EXPECT_THAT(back.error().line(), ::testing::HasSubstr("tile.h5"));
  }
}

TEST(Arrays, AFileCutShortOrTooLongIsDamaged) {
  const std::vector<std::byte> image = *encode_arrays(sample());
  for (const std::size_t n :
       {std::size_t{0}, std::size_t{1}, std::size_t{79}, std::size_t{80}, image.size() / 2, image.size() - 1}) {
    const auto back = decode_arrays(std::span(image).first(n), "x");
    ASSERT_FALSE(back) << n;
    EXPECT_EQ(back.error().code, ErrorCode::damaged);
  }
  std::vector<std::byte> longer = image;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(decode_arrays(longer, "x"));
}

TEST(Arrays, SomethingElseIsDamagedNotACrash) {
  const std::string text(5000, 'z');
  const auto back = decode_arrays(std::as_bytes(std::span(text)), "x");
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::damaged);
}

TEST(Arrays, AskingForAnotherTypeNamesTheColumn) {
  const ArraySet arrays = sample();
  EXPECT_TRUE(arrays.column<double>("f64"));
  const auto missing = arrays.column<float>("f64");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().line(), ::testing::HasSubstr("f64"));
}

TEST(Arrays, AColumnNameThatHdf5CannotHoldIsRefused) {
  ArraySet arrays;
  arrays.kind = "k";
  arrays.columns["a/b"] = std::vector<float>{1.0F};
  EXPECT_FALSE(encode_arrays(arrays));
}

}  // namespace
}  // namespace rayfield::tile::testing
