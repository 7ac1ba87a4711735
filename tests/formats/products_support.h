#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "tests/formats/temporary_file.h"

/// What the tests of GIS products share.
namespace rayfield::formats::testing {

inline constexpr float kNanFloat = std::numeric_limits<float>::quiet_NaN();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

inline std::string message(const Result<void>& result) { return result ? "no error" : result.error().line(); }

/// Runs one of GDAL's sample validators; fails the test with its output. Without the Python modules nothing is checked,
/// and the log says so.
inline void expect_valid(const std::string& module, const std::string& options, const std::string& path) {
  const char* chosen = std::getenv("RAYFIELD_PYTHON");
  const std::string python = chosen == nullptr ? "/usr/bin/python3" : chosen;
  if (std::system((python + " -c 'import osgeo_utils.samples." + module + "' >/dev/null 2>&1").c_str()) != 0) {
    GTEST_SKIP() << "GDAL's Python validators are not installed (python3-gdal)";
  }
  const std::string log = path + ".log";
  const std::string command =
      python + " -m osgeo_utils.samples." + module + " " + options + " '" + path + "' >'" + log + "' 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << read_file(log);
  std::filesystem::remove(log);
}
inline void expect_valid_cog(const std::string& path) {
  expect_valid("validate_cloud_optimized_geotiff", "--full-check=yes", path);
}
inline void expect_valid_geopackage(const std::string& path) {
  expect_valid("validate_gpkg", "--extra --warning-as-error", path);
}

/// A block of straight rows running north, 2.75 m apart, panels of 6.5 m, one value per panel and date.
inline BlockProducts make_block(int rows, int panels_per_row, const std::vector<std::string>& dates) {
  BlockProducts block;
  block.block = "block a";
  block.crs = "EPSG:7854";
  const Eigen::Vector2d corner(276196.4736, 6099944.0749);
  for (int r = 0; r < rows; ++r) {
    const Eigen::Vector2d start = corner + Eigen::Vector2d(2.75 * r, 0);
    const double length = 6.5 * panels_per_row;
    block.rows.push_back({"row-" + std::to_string(r + 1),
                          r + 1,
                          {start, start + Eigen::Vector2d(0, length)},
                          length,
                          rows > 1 ? 2.75 : kNan});
    for (int p = 0; p < panels_per_row; ++p) {
      const Eigen::Vector2d a = start + Eigen::Vector2d(-0.5, 6.5 * p), b = a + Eigen::Vector2d(1.0, 6.5);
      const std::string uid = "panel-" + std::to_string(r + 1) + "-" + std::to_string(p + 1);
      block.panels.push_back({uid, r + 1, p + 1, 6.5 * p, 6.5 * (p + 1), 6.5, {a, {b.x(), a.y()}, b, {a.x(), b.y()}}});
      block.posts.push_back({"post-" + uid, r + 1, 6.5 * p, start + Eigen::Vector2d(0, 6.5 * p), 82.25, 1.8, p != 1});
    }
  }
  for (std::size_t d = 0; d < dates.size(); ++d) {
    ScanResults results;
    results.scan = {"scan-" + dates[d],  dates[d], "name", dates[d] + "T00:01:54.770Z", dates[d] + "T01:02:03.004Z",
                    3'200'000'000'000ULL};
    for (const PanelProduct& panel : block.panels) {
      PanelValue v;
      v.panel_uid = panel.panel_uid;
      v.scan_id = results.scan.scan_id;
      v.scan_date = dates[d];
      v.leaf_area_per_m = 1.25 * panel.row_number + 0.5 * panel.panel_number + 0.125 * static_cast<double>(d);
      v.leaf_area_m2 = v.leaf_area_per_m * panel.length_m;
      v.plant_area_m2 = v.leaf_area_m2 + 2;
      v.lai = v.leaf_area_per_m / 2.75;
      v.se_leaf_area_m2 = 0.25, v.ci_low_m2 = v.leaf_area_m2 - 0.5, v.ci_high_m2 = v.leaf_area_m2 + 0.5;
      v.canopy_height_m = 1.75, v.canopy_width_m = 0.625, v.gap_fraction = 0.375, v.observed_fraction = 0.9375;
      v.se_plant_area_m2 = 0.1875, v.plant_ci_low_m2 = v.plant_area_m2 - 0.375;
      v.plant_ci_high_m2 = v.plant_area_m2 + 0.375, v.ray_count = 5'000'000'000LL;
      v.descriptors = {0.875, 0.0625, 0.1875, 2.5, 0.75, 0.5, 2.25};
      for (const double low : {0.75, 1.0})
        results.profile.push_back(
            {v.panel_uid, v.scan_id, v.scan_date, low, low + 0.25, v.plant_area_m2 / 2, v.leaf_area_m2 / 2});
      results.panel_values.push_back(v);
    }
    for (const RowProduct& row : block.rows) {
      for (double chainage = 0.25; chainage < row.length_m; chainage += 0.5) {
        results.row_metres.push_back({row.row_number,
                                      chainage,
                                      row.centreline[0] + Eigen::Vector2d(0, chainage),
                                      results.scan.scan_id,
                                      dates[d],
                                      0.125 * chainage,
                                      0.25 * chainage,
                                      1.5,
                                      0.5,
                                      {0.75, 0, 0.25, 2, 0.875, 0.375, kNan}});
      }
    }
    block.scans.push_back(std::move(results));
  }
  return block;
}

}  // namespace rayfield::formats::testing
