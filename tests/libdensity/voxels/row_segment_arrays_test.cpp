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
  const auto list = make_row_segmentes(two_rows(BlockShape{}, 2.5), ground, {}, {});
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
  tile::ArraySet wrong = row_segments_to_arrays(*list);
  std::get<std::vector<std::int32_t>>(wrong.columns["n_up"])[0] = 0;
  EXPECT_EQ(row_segments_from_arrays(wrong).error().code, ErrorCode::damaged);
}

}  // namespace
}  // namespace rayfield::density
