#include "libdensity/scan/scan_sides.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayfield::density {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Rows northward, 2.5 m apart, 40 m long; the first at x = 0.
RowLayout rows(int count) {
  RowLayout layout;
  for (int i = 0; i < count; ++i) {
    Row row;
    row.number = i + 1, row.farm_number = 11 + i;
    row.centreline = {{2.5 * i, 0}, {2.5 * i, 40}};
    layout.rows.push_back(row);
  }
  return layout;
}

/// Along lanes at x, from y = −3 m to `until` and on to the next lane.
std::vector<PathPoint> drive(std::initializer_list<std::pair<double, double>> lanes) {
  std::vector<PathPoint> path;
  double time_s = 0;
  bool north = true;
  for (const auto& [x, until] : lanes) {
    const int steps = static_cast<int>((until + 3) / 0.25);
    for (int i = 0; i <= steps; ++i, time_s += 0.2)
      path.push_back({time_s, {x, north ? -3 + 0.25 * i : until - 0.25 * i, 1.5}});
    time_s += 60;  // turning
    north = !north;
  }
  return path;
}

TEST(ScanSides, RowsBesideOneLaneOnlyAreSeenFromOneSide) {
  const RowLayout layout = rows(3);
  EXPECT_THAT(rows_from_one_side(layout, drive({{-1.25, 43}, {1.25, 43}, {3.75, 43}, {6.25, 43}}), {}), IsEmpty());
  EXPECT_THAT(rows_from_one_side(layout, drive({{1.25, 43}, {3.75, 43}}), {}), ElementsAre(1, 3));
  EXPECT_THAT(rows_from_one_side(layout, drive({{1.25, 43}}), {}), ElementsAre(1, 2));  // the third not at all
  // A lane that was left after a third of the row shows its other side there only.
  EXPECT_THAT(rows_from_one_side(layout, drive({{-1.25, 13}, {1.25, 43}, {3.75, 43}, {6.25, 30}}), {}), ElementsAre(1));
}

TEST(ScanSides, TheirErrorIsLargerWhereBeamsAreWide) {
  const IntegrationOptions usual;
  tile::ScanEntry thin, wide;
  wide.beam = LidarBeam{0.0136, 0.0119, {}};
  const std::vector<int> one{2};
  EXPECT_EQ(integration_of_row(usual, wide, 1, one).shared_error, usual.shared_error);
  EXPECT_NEAR(integration_of_row(usual, wide, 2, one).shared_error, std::hypot(usual.shared_error, 0.12), 1e-12);
  EXPECT_NEAR(integration_of_row(usual, thin, 2, one).shared_error, std::hypot(usual.shared_error, 0.03), 1e-12);
}

TEST(ScanSides, AreSaidByTheFarmsNumbers) {
  tile::ScanEntry scan;
  scan.scan_id = "2020-01-15";
  EXPECT_EQ(one_side_note(scan, rows(3), {}), "");
  EXPECT_THAT(one_side_note(scan, rows(3), std::vector{1, 3}),
              HasSubstr("rows 11, 13 of 2020-01-15 were driven past on one side only"));
  EXPECT_THAT(one_side_note(scan, rows(3), std::vector{2}), HasSubstr("row 12 of 2020-01-15 was driven past"));
}

}  // namespace
}  // namespace rayfield::density
