#include "formats/geopackage/gpkg_schema.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "rayfield/formats/geopackage.h"
#include "tests/formats/geopackage/geopackage_reader.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using testing::GeopackageReader;
using testing::make_block;
using testing::message;
using testing::TemporaryFolder;

const std::vector<std::string> kTwoDates = {"2018-12-12", "2019-02-11"};

TEST(GeoPackageSchema, TablesHaveTheColumnsOfTheContract) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_geopackage(make_block(3, 4, kTwoDates), folder / "a.gpkg"));
  const GeopackageReader reader(folder / "a.gpkg");
  ASSERT_TRUE(reader.good());
  const std::map<std::string, std::vector<std::string>> contract = {
      {"panel",
       {"panel_uid", "row_number", "panel_number", "length_m", "row_name", "valid_from", "valid_to", "source"}},
      {"vine_row", {"row_uid", "row_number", "length_m", "row_name", "valid_from", "valid_to", "source"}},
      {"post", {"post_uid", "row_number", "detected", "row_name", "valid_from", "valid_to", "source"}},
      {"block", {"block", "farm", "variety"}},
      {"scan",
       {"scan_id", "scan_date", "start_utc", "end_utc", "name", "ray_count", "offset_e_m", "offset_n_m", "offset_h_m",
        "yaw_mrad", "residual_m", "landmarks", "aligned", "wood_scan_id", "leaf_note", "fruit_zone_low_m",
        "fruit_zone_high_m", "wood_from"}},
      {"panel_value",
       {"panel_uid",
        "scan_id",
        "scan_date",
        "plant_area_m2",
        "leaf_area_m2",
        "leaf_area_per_m",
        "lai",
        "se_leaf_area_m2",
        "ci_low_m2",
        "ci_high_m2",
        "canopy_height_m",
        "canopy_width_m",
        "gap_fraction",
        "observed_fraction",
        "ray_count",
        "se_plant_area_m2",
        "plant_ci_low_m2",
        "plant_ci_high_m2",
        "wood_scan_id",
        "canopy_base_m",
        "row_gap_share",
        "porosity",
        "leaf_layer_number",
        "exposed_leaf_share",
        "fruit_zone_area_per_m",
        "fruit_zone_density",
        "wood_from"}},
      {"panel_profile",
       {"panel_uid", "scan_id", "scan_date", "height_low_m", "height_high_m", "plant_area_m2", "leaf_area_m2"}},
      {"row_metre",
       {"row_number", "chainage_m", "scan_date", "leaf_area_per_m", "plant_area_per_m", "canopy_height_m",
        "canopy_width_m", "canopy_base_m", "row_gap_share", "porosity", "leaf_layer_number", "exposed_leaf_share",
        "fruit_zone_area_per_m", "fruit_zone_density"}},
      {"panel_by_date", {"OGC_FID", "geom", "panel_uid", "scan_date", "leaf_area_per_m"}},
      {"panel_wide", {"panel_uid", "leaf_area_per_m_2018_12_12", "leaf_area_per_m_2019_02_11"}}};
  for (const auto& [table, wanted] : contract) {
    const std::vector<std::string> columns = reader.columns(table);
    const std::set<std::string> present(columns.begin(), columns.end());
    for (const std::string& column : wanted) EXPECT_TRUE(present.count(column)) << table << "." << column;
  }
  EXPECT_EQ(reader.columns("panel_by_date").front(), "OGC_FID");
  const std::map<std::string, OGRwkbGeometryType> geometry = {
      {"vine_row", wkbLineString}, {"panel", wkbPolygon},         {"post", wkbPoint},      {"scan", wkbNone},
      {"panel_value", wkbNone},    {"panel_by_date", wkbPolygon}, {"row_metre", wkbPoint}, {"panel_wide", wkbPolygon}};
  for (const auto& [name, type] : geometry) {
    ASSERT_NE(reader.layer(name), nullptr) << name;
    EXPECT_EQ(reader.layer(name)->GetGeomType(), type) << name;
    if (type == wkbNone) continue;
    ASSERT_NE(reader.layer(name)->GetSpatialRef(), nullptr) << name;
    EXPECT_STREQ(reader.layer(name)->GetSpatialRef()->GetAuthorityCode(nullptr), "7854");
  }
}

TEST(GeoPackageSchema, EveryMeasuredColumnSaysItsUnit) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_geopackage(make_block(2, 2, kTwoDates), folder / "a.gpkg"));
  const GeopackageReader reader(folder / "a.gpkg");
  for (const char* table : {"vine_row", "panel", "post", "scan", "panel_value", "panel_profile", "row_metre",
                            "panel_by_date", "panel_wide"}) {
    for (const std::string& column : reader.columns(table)) {
      if (column == "fid" || column == "OGC_FID" || column == "geom") continue;
      const std::string text = reader.value("SELECT description FROM gpkg_data_columns WHERE table_name = '" +
                                            std::string(table) + "' AND column_name = '" + column + "'");
      EXPECT_GT(text.size(), 7U) << table << "." << column << ": " << text;
      const auto ends_with = [&](const std::string& end) {
        return column.size() > end.size() && column.compare(column.size() - end.size(), end.size(), end) == 0;
      };
      if (ends_with("_m2")) {
        EXPECT_NE(text.find(" m²"), std::string::npos) << column;
      }
      if (ends_with("_per_m")) {
        EXPECT_NE(text.find(" m²/m"), std::string::npos) << column;
      }
      if (ends_with("_m")) {
        EXPECT_NE(text.find(" m"), std::string::npos) << column;
      }
    }
  }
}

}  // namespace
}  // namespace rayfield::formats
