#include "libdensity/integration/raster_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rayfield::density {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Rows of 50 m running north, `spacing_m` apart, the first at (east, north).
RowLayout make_layout(int rows, double spacing_m, double east = 276201.37, double north = 6099944.12) {
  RowLayout layout;
  layout.spacing_m = rows > 1 ? spacing_m : kNaN;
  for (int i = 0; i < rows; ++i) {
    const Eigen::Vector2d start(east + i * spacing_m, north);
    layout.rows.push_back({i + 1, {start, start + Eigen::Vector2d(0.4, 50)}, true, true});
  }
  return layout;
}

Result<Grid2<float>> fit_to_frame(const Grid2<float>& map, const RasterFrame& frame) {
  RAYFIELD_ASSIGN(const FittedMap fitted, FittedMap::create(map, frame));
  Grid2<float> out(frame.origin, frame.cell_m, frame.nx, frame.ny);
  for (int iy = 0; iy < frame.ny; ++iy)
    RAYFIELD_CHECK(fitted.read_row(iy, std::span(out.values).subspan(out.index(0, iy), out.nx),
                                   [&](std::uint64_t first, std::span<float> values) -> Result<void> {
                                     std::copy_n(map.values.begin() + static_cast<std::ptrdiff_t>(first), values.size(),
                                                 values.begin());
                                     return {};
                                   }));
  return out;
}

TEST(RasterFrame, LiesAtWholeStepsOfCellsAndHoldsTheRowsWithTheirMargin) {
  for (const double cell : {0.05, 0.1, 0.25, 0.3}) {
    const auto frame = plan_frame(make_layout(4, 2.75), cell);
    ASSERT_TRUE(frame.has_value()) << frame.error().line();
    const Eigen::Vector2d steps = frame->origin / (64 * cell);
    EXPECT_NEAR(steps.x(), std::round(steps.x()), 1e-6);
    EXPECT_NEAR(steps.y(), std::round(steps.y()), 1e-6);
    EXPECT_EQ(frame->nx % 64, 0);
    EXPECT_EQ(frame->ny % 64, 0);
    const double high_x = frame->origin.x() + frame->nx * cell, high_y = frame->origin.y() + frame->ny * cell;
    EXPECT_LE(frame->origin.x(), 276201.37 - 4);
    EXPECT_LE(frame->origin.y(), 6099944.12 - 4);
    EXPECT_GE(high_x, 276201.37 + 3 * 2.75 + 0.4 + 4);
    EXPECT_GE(high_y, 6099944.12 + 50 + 4);
    EXPECT_LT(frame->nx * cell, 3 * 2.75 + 0.4 + 8 + 2 * 64 * cell) << "no larger than it must be";
  }
}

TEST(RasterFrame, WideLanesAreHeldByTheMargin) {
  const auto frame = plan_frame(make_layout(2, 12.0), 0.1);
  ASSERT_TRUE(frame.has_value());
  EXPECT_LE(frame->origin.x(), 276201.37 - 6);
  EXPECT_GE(frame->origin.x() + 0.1 * frame->nx, 276201.37 + 12 + 6);
}

TEST(RasterFrame, AVertexMovedByCentimetresLeavesItAndRowsPlantedOutsideGrowItByWholeSteps) {
  const auto frame = *plan_frame(make_layout(4, 2.75), 0.1);
  const auto moved = *plan_frame(make_layout(4, 2.75, 276201.42, 6099944.09), 0.1);
  EXPECT_EQ(moved.origin, frame.origin);
  EXPECT_EQ(moved.nx, frame.nx);
  EXPECT_EQ(moved.ny, frame.ny);

  const auto east = *plan_frame(make_layout(8, 2.75), 0.1);
  EXPECT_EQ(east.origin, frame.origin) << "rows planted in the east";
  EXPECT_GT(east.nx, frame.nx);
  const auto west = *plan_frame(make_layout(8, 2.75, 276201.37 - 4 * 2.75), 0.1);
  const double shift = (frame.origin.x() - west.origin.x()) / 0.1;
  EXPECT_GT(shift, 0) << "rows planted in the west";
  EXPECT_NEAR(shift / 64, std::round(shift / 64), 1e-6);
}

TEST(RasterFrame, TheGroundsFrameHoldsTheHeadlands) {
  const auto frame = *ground_frame(make_layout(4, 2.75), 0.25);
  EXPECT_LE(frame.origin.y(), 6099944.12 - 10);
  EXPECT_GE(frame.origin.y() + 0.25 * frame.ny, 6099944.12 + 60);
}

TEST(RasterFrame, NoRowsAndTooManyCellsAreRefused) {
  EXPECT_EQ(plan_frame(RowLayout{}, 0.1).error().code, ErrorCode::usage);
  EXPECT_EQ(plan_frame(make_layout(2, 30000.0), 0.001).error().code, ErrorCode::resources);
}

TEST(RasterFrame, AMapIsMovedIntoItByWholeCells) {
  const RasterFrame frame = *plan_frame(make_layout(2, 2.75), 0.1);
  // 3 × 2 cells, of which the first column lies west of the frame.
  Grid2<float> map(frame.origin + 0.1 * Eigen::Vector2d(-1, 5), 0.1, 3, 2);
  for (std::size_t i = 0; i < 6; ++i) map.values[i] = static_cast<float>(i);
  const auto fitted = fit_to_frame(map, frame);
  ASSERT_TRUE(fitted.has_value()) << fitted.error().line();
  EXPECT_EQ(fitted->at(0, 5), 1.0F);
  EXPECT_EQ(fitted->at(1, 5), 2.0F);
  EXPECT_EQ(fitted->at(0, 6), 4.0F);
  EXPECT_EQ(fitted->at(1, 6), 5.0F);
  EXPECT_TRUE(std::isnan(fitted->at(2, 5)));
  EXPECT_TRUE(std::isnan(fitted->at(0, 4)));

  map.origin = frame.origin - Eigen::Vector2d(500, 500);
  const auto outside = fit_to_frame(map, frame);
  ASSERT_TRUE(outside.has_value());
  for (const float v : outside->values) ASSERT_TRUE(std::isnan(v));
}

TEST(RasterFrame, AMapWithOtherCellsIsRefused) {
  const RasterFrame frame = *plan_frame(make_layout(2, 2.75), 0.1);
  const Grid2<float> larger(frame.origin, 0.2, 3, 2), between(frame.origin + Eigen::Vector2d(0.04, 0), 0.1, 3, 2);
  EXPECT_EQ(fit_to_frame(larger, frame).error().code, ErrorCode::usage);
  EXPECT_EQ(fit_to_frame(between, frame).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::density
