#include "formats/rosbag/point_cloud2.h"

#include <gtest/gtest.h>

#include "tests/formats/bag_bytes.h"

namespace rayfield::formats {
namespace {

using namespace bytes;

std::span<const std::byte> bytes_of(const std::string& message) { return std::as_bytes(std::span(message)); }

TEST(PointCloud2, RowsWithoutPointsAreNone) {
  // Four billion rows of no points take no bytes at all.
  const std::string message = header(1, 0) + u32(0xffffffff) + u32(0) + u32(1) + counted("x") + u32(0) + u8(7) +
                              u32(1) + u8(0) + u32(4) + u32(0) + counted("") + u8(1);
  const auto cloud = decode_point_cloud2(bytes_of(message));
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->points(), 0U);
  EXPECT_EQ(cloud->height, 0U);
}

TEST(PointCloud2, RowsThatReachBeyondTheDataAreRefused) {
  const std::vector<CloudField> fields = {{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}};
  const std::string good = cloud(1, 0, fields, 12, std::string(24, '\0'));
  const auto read = decode_point_cloud2(bytes_of(good));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->points(), 2U);
  std::string bad = good;
  bad[header(1, 0).size()] = 2;  // the height
  EXPECT_FALSE(decode_point_cloud2(bytes_of(bad)));
}

}  // namespace
}  // namespace rayfield::formats
