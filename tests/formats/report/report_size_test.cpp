#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "tests/formats/report/report_support.h"

namespace rayfield::formats {
namespace {

// One-sided areas of leaves in cells: exponential, no cell like its neighbour, as unfriendly to packing as leaves are.
class Leaves {
 public:
  float next(double mean) {
    random_ = random_ * 6364136223846793005ULL + 1442695040888963407ULL;
    const double u = (static_cast<double>(random_ >> 11U) + 1) / 9007199254740993.0;
    return static_cast<float>(-mean * std::log(u));
  }

 private:
  std::uint64_t random_ = 1;
};

// 40 rows of 200 m on six dates: side views in cells of 7 cm, 2.2 m high with 1.1 m of canopy, maps of 0.1 m cells with
// canopies 0.6 m wide, rows 2.75 m apart.
BlockReport large_report() {
  BlockProducts block =
      testing::make_block(40, 31, {"2018-08-06", "2018-11-22", "2019-02-11", "2019-08-06", "2019-11-22", "2020-02-11"});
  Leaves leaves;
  BlockReport report = testing::make_report(block);
  for (ScanResults& scan : report.block.scans) {
    scan.sections.clear();
    for (int row = 1; row <= 40; ++row) {
      Grid2<float> side({0, 0}, 0.07, 2879, 31, 0.0F);
      for (int y = 11; y < 27; ++y)
        for (int x = 0; x < side.nx; ++x) side.at(x, y) = leaves.next(1.5);
      scan.sections.push_back({"side_view_row_" + std::to_string(row), "m2/m2", row, std::move(side)});
    }
  }
  for (ReportScan& scan : report.scans) {
    Grid2<float> map(report.block.rows[0].centreline[0] - Eigen::Vector2d(2, 2), 0.1, 1152, 2112, 0.0F);
    for (int row = 0; row < 40; ++row) {
      const double middle_m = 2 + 2.75 * row;
      for (int x = static_cast<int>(10 * (middle_m - 0.3)); x < static_cast<int>(10 * (middle_m + 0.3)); ++x)
        for (int y = 20; y < 2035; ++y) map.at(x, y) = leaves.next(4);
    }
    scan.plan_density = coarser(map, report_map_factor(map, report.scans.size(), {}));
    for (int i = 0; i < 400; ++i) scan.gaps.push_back(scan.gaps[0]), scan.seen_as_gap.push_back(3);
  }
  for (int i = 1; i < 15; ++i) report.comparisons.push_back(report.comparisons[0]);
  return report;
}

TEST(ReportSize, FortyRowsOnSixDatesFitIntoFiveMegabytes) {
  const auto html = report_html(large_report());
  ASSERT_TRUE(html) << html.error().line();
  RecordProperty("bytes", static_cast<int>(html->size()));
  EXPECT_LE(html->size(), 5'000'000U);
  EXPECT_GT(html->size(), 1'000'000U) << "the maps must be in it";
}

}  // namespace
}  // namespace rayfield::formats
