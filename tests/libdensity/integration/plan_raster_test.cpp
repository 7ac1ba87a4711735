#include "libdensity/integration/plan_raster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "libdensity/integration/raster_frame.h"
#include "tests/libdensity/plan_values.h"
#include "tests/libdensity/random_row.h"

namespace rayfield::density {
namespace {

using testing::kAllInMemory;
using testing::random_row;
using testing::scratch;
using testing::values_of;

// A map that holds the row and nothing beyond.
Result<RasterFrame> frame_of(const RowDensity& row, double cell_m) {
  Eigen::AlignedBox2d box;
  for (int a = 0; a < row.n_along; ++a)
    for (const int c : {0, row.n_across - 1}) {
      box.extend(Eigen::Vector2d(row.center(a, c).array() - row.voxel_m));
      box.extend(Eigen::Vector2d(row.center(a, c).array() + row.voxel_m));
    }
  return frame_around(box, cell_m);
}

double direct_sum(const RowDensity& r) {
  return std::accumulate(r.density.begin(), r.density.end(), 0.0) * std::pow(r.voxel_m, 3);
}

TEST(PlanRaster, HoldsTheSameAreaAtAnyCellSize) {
  const RowDensity row = random_row(2);
  for (const double cell : {0.05, 0.1, 0.25, 1.0}) {
    const auto frame = frame_of(row, cell);
    ASSERT_TRUE(frame.has_value());
    auto raster = PlanRaster::create(*frame, row.row_segments, {cell, 0.97}, kAllInMemory, scratch());
    ASSERT_TRUE(raster.has_value());
    ASSERT_TRUE(raster->add(row).has_value());
    const RasterProduct map = raster->maps()[0];
    ASSERT_EQ(map.name, "plan_density");
    double sum = 0;
    for (const float v : values_of(*raster, 0))
      if (std::isfinite(v)) sum += static_cast<double>(v) * cell * cell;
    EXPECT_NEAR(sum, direct_sum(row), 1e-5 * sum) << cell;
    const Eigen::Vector2d steps = map.grid.origin / cell;
    EXPECT_NEAR(steps.x(), std::round(steps.x()), 1e-6);
    EXPECT_NEAR(steps.y(), std::round(steps.y()), 1e-6);
  }
}

TEST(PlanRaster, HoldsTheSameToTheLastBitHoweverLittleOfItIsInMemory) {
  const RowDensity one = random_row(5);
  const RowDensity other = [] {
    RowDensity row = random_row(6);
    for (RowSegment& s : row.row_segments) s.origin += Eigen::Vector2d(3, -4);
    return row;
  }();
  std::vector<RowSegment> row_segments = one.row_segments;
  row_segments.insert(row_segments.end(), other.row_segments.begin(), other.row_segments.end());
  // Cells of 1 cm, so that the rows lie on many pages.
  const RasterFrame frame{one.row_segments[0].origin - Eigen::Vector2d(12, 12), 0.01, 2400, 2400};
  std::vector<std::vector<float>> maps[2];
  for (const std::size_t bytes : {kAllInMemory, std::size_t{1}}) {
    auto raster = PlanRaster::create(frame, row_segments, {0.01, 0.97}, bytes, scratch());
    ASSERT_TRUE(raster.has_value());
    for (const RowDensity* row : {&one, &other, &one}) ASSERT_TRUE(raster->add(*row).has_value());
    ASSERT_TRUE(raster->mark_scanned(frame.origin + Eigen::Vector2d(23, 1)).has_value());
    for (std::size_t map = 0; map < raster->maps().size(); ++map)
      maps[bytes == 1 ? 1 : 0].push_back(values_of(*raster, map));
  }
  ASSERT_EQ(maps[0].size(), 3U);
  for (std::size_t map = 0; map < 3; ++map) {
    std::size_t known = 0;
    for (std::size_t i = 0; i < maps[0][map].size(); ++i) {
      const float a = maps[0][map][i], b = maps[1][map][i];
      ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << map << ", cell " << i;
      known += std::isnan(a) ? 0U : 1U;
    }
    EXPECT_GT(known, 10000U);
  }
}

TEST(PlanRaster, IsEmptyWhereItWasScannedAndNoColumnStands) {
  const RowDensity row = random_row(1);
  const RasterFrame frame{row.row_segments[0].origin - Eigen::Vector2d(64, 64), 0.1, 1280, 1280};
  auto raster = PlanRaster::create(frame, row.row_segments, {}, kAllInMemory, scratch());
  ASSERT_TRUE(raster.has_value());
  ASSERT_TRUE(raster->add(row).has_value());
  const std::vector<float> before = values_of(*raster, 0);
  const Eigen::Vector2d lane = frame.origin + Eigen::Vector2d(1.05, 2.05), column = row.center(3, 3);
  ASSERT_TRUE(raster->mark_scanned(lane).has_value());
  ASSERT_TRUE(raster->mark_scanned(column).has_value());
  ASSERT_TRUE(raster->mark_scanned(frame.origin - Eigen::Vector2d(5, 5)).has_value()) << "beyond the frame";
  const std::vector<float> after = values_of(*raster, 1), density = values_of(*raster, 0);
  const std::size_t cell = 20 * 1280 + 10;
  EXPECT_TRUE(std::isnan(before[cell]));
  EXPECT_EQ(density[cell], 0);
  EXPECT_EQ(after[cell], 0);
  const Eigen::Vector2d at = (column - frame.origin) / 0.1;
  const auto seen = static_cast<std::size_t>(at.y()) * 1280 + static_cast<std::size_t>(at.x());
  EXPECT_GT(before[seen], 0);
  EXPECT_EQ(density[seen], before[seen]);
}

TEST(PlanRaster, IsUnknownWhereNothingWasSeen) {
  RowDensity row = random_row(8);
  std::fill(row.density.begin(), row.density.end(), 0.0F);
  std::fill(row.state.begin(), row.state.end(), VoxelState::unobserved);
  const auto frame = frame_of(row, 0.1);
  ASSERT_TRUE(frame.has_value());
  auto raster = PlanRaster::create(*frame, row.row_segments, {}, kAllInMemory, scratch());
  ASSERT_TRUE(raster.has_value());
  ASSERT_TRUE(raster->add(row).has_value());
  for (std::size_t map = 0; map < raster->maps().size(); ++map)
    for (const float v : values_of(*raster, map)) EXPECT_TRUE(std::isnan(v));
}

TEST(PlanRaster, TheStandardErrorOfACellAddsIndependentColumns) {
  RowDensity row = random_row(7);
  std::fill(row.variance.begin(), row.variance.end(), 0.0F);
  row.variance[row.index(4, 4, 3)] = 9.0F;
  const auto frame = frame_of(row, 10.0);  // cells larger than the row
  ASSERT_TRUE(frame.has_value());
  auto raster = PlanRaster::create(*frame, row.row_segments, {10.0, 0.97}, kAllInMemory, scratch());
  ASSERT_TRUE(raster.has_value());
  ASSERT_TRUE(raster->add(row).has_value());
  double variance = 0;  // the column may lie across a border of cells: compare shares² only when it does not
  for (const float v : values_of(*raster, 1))
    if (std::isfinite(v)) variance += std::pow(static_cast<double>(v) * 100.0, 2);
  const double expected = 9.0 * std::pow(0.12, 6);
  EXPECT_LE(variance, expected * 1.0001);
  EXPECT_GE(variance, expected * 0.25);
}

TEST(PlanRaster, OverlapOfASquareTurnedByFortyFiveDegreesIsExact) {
  // A unit diamond about the origin (diagonal √2): a quarter of it lies in the first quadrant's box.
  const double h = std::sqrt(0.5);
  const std::vector<Eigen::Vector2d> diamond = {{h, 0}, {0, h}, {-h, 0}, {0, -h}};
  EXPECT_NEAR(overlap_area(diamond, {0, 0}, {1, 1}), 0.25, 1e-12);
  EXPECT_NEAR(overlap_area(diamond, {-2, -2}, {2, 2}), 1.0, 1e-12);
  EXPECT_NEAR(overlap_area(diamond, {0.5, -1}, {1, 1}), (h - 0.5) * (h - 0.5), 1e-12);
  EXPECT_EQ(overlap_area(diamond, {1, 1}, {2, 2}), 0);
}

TEST(PlanRaster, NoRowSegmentsAndOptionsOutOfRangeAreRefused) {
  const RowDensity row = random_row(1);
  const RasterFrame frame{row.row_segments[0].origin - Eigen::Vector2d(64, 64), 0.1, 1280, 1280};
  EXPECT_EQ(PlanRaster::create(frame, {}, {}, kAllInMemory, scratch()).error().code, ErrorCode::bad_input);
  EXPECT_FALSE(PlanRaster::create(frame, row.row_segments, {0.0, 0.97}, kAllInMemory, scratch()).has_value());
  EXPECT_TRUE(PlanRaster::create(frame, row.row_segments, {}, kAllInMemory, scratch()).has_value());
}

TEST(PlanRaster, ARowThatReachesBeyondTheFrameIsRefusedInsteadOfCut) {
  const RowDensity row = random_row(1);
  const RasterFrame frame{row.row_segments[0].origin, 0.1, 64, 64};
  EXPECT_EQ(PlanRaster::create(frame, row.row_segments, {}, kAllInMemory, scratch()).error().code, ErrorCode::internal);
}

TEST(PlanRaster, ADiskThatCannotTakeItsPagesIsAnErrorOfResources) {
  const RowDensity row = random_row(1);
  const RasterFrame frame{row.row_segments[0].origin - Eigen::Vector2d(12, 12), 0.01, 2400, 2400};
  auto raster = PlanRaster::create(frame, row.row_segments, {0.01, 0.97}, 1, "/nonexistent");
  ASSERT_TRUE(raster.has_value());
  const auto added = raster->add(row);
  ASSERT_FALSE(added.has_value());
  EXPECT_EQ(added.error().code, ErrorCode::resources);
}

}  // namespace
}  // namespace rayfield::density
