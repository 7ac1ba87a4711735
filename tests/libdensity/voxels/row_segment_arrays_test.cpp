#include "libdensity/voxels/row_segment_arrays.h"

#include <gtest/gtest.h>

#include "tests/libdensity/scene.h"

namespace rayfield::density {
namespace {

using testing::BlockShape;
using testing::exact_ground;
using testing::two_rows;

TEST(RowSegments, SurviveStorage) {
  const GroundModel ground = exact_ground([](double x, double) { return 0.02 * (x - 500000); });
  const auto list = make_row_segments(two_rows(BlockShape{}, 2.5), ground, {}, {});
  ASSERT_TRUE(list);
  const auto back = row_segments_from_arrays(row_segments_to_arrays(*list));
  ASSERT_TRUE(back) << back.error().line();
  ASSERT_EQ(back->row_segments.size(), list->row_segments.size());
  for (std::size_t i = 0; i < list->row_segments.size(); ++i) {
    EXPECT_EQ(back->row_segments[i].origin, list->row_segments[i].origin);
    EXPECT_EQ(back->row_segments[i].slope_across, list->row_segments[i].slope_across);
    EXPECT_EQ(back->row_segments[i].n_up, list->row_segments[i].n_up);
  }
  EXPECT_EQ(back->extents.size(), 2U);
}

TEST(RowSegments, ThatCannotBeAreRefused) {
  const auto list =
      make_row_segments(two_rows(BlockShape{}, 2.5), exact_ground([](double, double) { return 0.0; }), {}, {});
  ASSERT_TRUE(list);
  const auto code_with = [&](const char* column, auto value) {
    tile::ArraySet arrays = row_segments_to_arrays(*list);
    std::get<std::vector<decltype(value)>>(arrays.columns[column])[0] = value;
    const auto read = row_segments_from_arrays(arrays);
    return read ? ErrorCode::internal : read.error().code;
  };
  for (const std::int32_t count : {0, -1, 2147483647})
    for (const char* column : {"n_along", "n_across", "n_up"})
      EXPECT_EQ(code_with(column, count), ErrorCode::damaged) << column << " " << count;
  for (const double number : {std::nan(""), 1e300, -1e300})
    for (const char* column : {"easting_m", "northing_m", "direction_east", "chainage_m", "ground_m", "slope_along",
                               "slope_across", "across_min_m", "up_min_m", "voxel_m"})
      EXPECT_EQ(code_with(column, number), ErrorCode::damaged) << column << " " << number;
}

}  // namespace
}  // namespace rayfield::density
