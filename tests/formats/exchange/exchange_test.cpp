#include "rayfield/formats/exchange.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <memory>

#include "rayfield/core/map_frame.h"
#include "tests/formats/gdal_dataset.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using testing::kNan;
using testing::make_block;
using testing::message;
using testing::read_file;
using testing::TemporaryFolder;

// Longitude and latitude as the CSV files have them, from a projection of our own.
std::string place(const std::string& crs, const Eigen::Vector2d& p_in_map) {
  const auto frame = MapFrame::create(crs);
  const Eigen::Vector3d geodetic = frame->geodetic_from_map({p_in_map.x(), p_in_map.y(), 0});
  return fmt::format("{:.9f},{:.9f}", geodetic.y(), geodetic.x());
}

testing::Dataset open(const std::string& path) { return testing::open_dataset(path, GDAL_OF_VECTOR); }

TEST(GeoJson, PanelsLieWhereTheyShouldInLongitudeAndLatitude) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(2, 2, {"2018-12-12", "2019-02-11"});
  std::reverse(block.panels[1].outline.begin(), block.panels[1].outline.end());  // clockwise: must be turned
  block.scans[1].panel_values[0].lai = kNan;
  block.scans[1].panel_values.pop_back();
  const auto written = write_panels(block, 1, PanelFormat::geojson, folder / "a.geojson");
  ASSERT_TRUE(written) << message(written);
  const testing::Dataset dataset = open(folder / "a.geojson");
  ASSERT_NE(dataset, nullptr);
  OGRLayer* layer = dataset->GetLayer(0);
  ASSERT_EQ(layer->GetFeatureCount(), 4);
  const auto frame = MapFrame::create("EPSG:7854");
  ASSERT_TRUE(frame);
  std::size_t i = 0;
  for (auto& feature : *layer) {
    const PanelProduct& panel = block.panels[i];
    EXPECT_EQ(panel.panel_uid, feature->GetFieldAsString("panel_uid"));
    const OGRLinearRing* ring = feature->GetGeometryRef()->toPolygon()->getExteriorRing();
    EXPECT_FALSE(ring->isClockwise());
    ASSERT_EQ(ring->getNumPoints(), 5);
    double nearest_deg = 1;
    const Eigen::Vector2d& corner = panel.outline[0];
    const Eigen::Vector3d expected = frame->geodetic_from_map({corner.x(), corner.y(), 0});
    for (int k = 0; k < 4; ++k) {
      nearest_deg = std::min(nearest_deg, std::hypot(ring->getX(k) - expected.y(), ring->getY(k) - expected.x()));
    }
    EXPECT_LT(nearest_deg, 2e-9);  // the file carries nine decimals
    ++i;
  }
  const std::string text = read_file(folder / "a.geojson");
  EXPECT_NE(text.find("\"lai\": null"), std::string::npos);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(text.find("\"crs\""), std::string::npos);  // RFC 7946 has no such member
}

TEST(GeoJson, ValuesAndAwkwardTextComeBack) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(1, 1, {"2019-02-11"});
  const std::string uid = "a \"quoted\" \\ <b> Grüner";
  block.panels[0].panel_uid = uid;
  block.scans[0].panel_values[0].panel_uid = uid;
  block.scans[0].panel_values[0].leaf_area_m2 = 0.1 + 0.2;
  ASSERT_TRUE(write_panels(block, 0, PanelFormat::geojson, folder / "a.geojson"));
  const testing::Dataset dataset = open(folder / "a.geojson");
  ASSERT_NE(dataset, nullptr);
  dataset->GetLayer(0)->ResetReading();
  const std::unique_ptr<OGRFeature> feature(dataset->GetLayer(0)->GetNextFeature());
  ASSERT_NE(feature, nullptr);
  EXPECT_EQ(uid, feature->GetFieldAsString("panel_uid"));
  EXPECT_EQ(feature->GetFieldAsDouble("leaf_area_m2"), 0.1 + 0.2);
  EXPECT_EQ(feature->GetFieldAsInteger64("ray_count"), 5'000'000'000LL);
  EXPECT_TRUE(feature->IsFieldNull(feature->GetFieldIndex("wood_scan_id"))) << "no wood was subtracted";
}

TEST(GeoJson, AScanThatDoesNotExistIsAUsageError) {
  const TemporaryFolder folder;
  const auto written = write_panels(make_block(1, 1, {"2019-02-11"}), 1, PanelFormat::geojson, folder / "a.geojson");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::usage);
  EXPECT_TRUE(folder.names().empty());
}

TEST(Csv, HasOneLinePerPanelAndDateAndEmptyFieldsForNan) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(1, 2, {"2018-12-12", "2019-02-11"});
  block.scans[0].panel_values[0].lai = kNan;
  block.scans[0].panel_values[1].scan_id = "x,\"y\"";
  block.scans[0].panel_values[0].wood_scan_id = "2018-07-20";
  block.scans[0].panel_values[0].wood_from = kWoodFromDormantScan;
  block.farm = "Hill Farm", block.variety = "=1+1, \"x\"";
  ASSERT_TRUE(write_panels_csv(block, folder / "a.csv"));
  std::istringstream lines(read_file(folder / "a.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(
      line,
      "panel_uid,row_number,panel_number,length_m,scan_id,scan_date,plant_area_m2,leaf_area_m2,leaf_area_per_m,"
      "lai,se_leaf_area_m2,ci_low_m2,ci_high_m2,canopy_height_m,canopy_width_m,gap_fraction,observed_fraction,"
      "se_plant_area_m2,plant_ci_low_m2,plant_ci_high_m2,ray_count,wood_scan_id,canopy_base_m,row_gap_share,porosity,"
      "leaf_layer_number,exposed_leaf_share,fruit_zone_area_per_m,fruit_zone_density,wood_from,block,farm,"
      "variety,longitude,latitude");
  std::getline(lines, line);
  EXPECT_EQ(
      line,
      "panel-1-1,1,1,6.5,scan-2018-12-12,2018-12-12,13.375,11.375,1.75,,0.25,10.875,11.875,1.75,0.625,0.375,"
      "0.9375,0.1875,13,13.75,5000000000,2018-07-20,0.875,0.0625,0.1875,2.5,0.75,0.5,2.25,dormant scan,block a,Hill "
      "Farm,\"=1+1, "
      "\"\"x\"\"\"," +
          place(block.crs, (block.panels[0].outline[0] + block.panels[0].outline[2]) / 2));
  std::getline(lines, line);
  EXPECT_NE(line.find(",\"x,\"\"y\"\"\",2018-12-12,"), std::string::npos) << line;
  int more = 0;
  while (std::getline(lines, line)) ++more;
  EXPECT_EQ(more, 2);
}

TEST(Csv, RowMetresCarryTheirPlace) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(1, 1, {"2019-02-11"});
  block.variety = "Shiraz";
  ASSERT_TRUE(write_row_metres_csv(block, folder / "m.csv"));
  std::istringstream lines(read_file(folder / "m.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line,
            "row_number,chainage_m,easting_m,northing_m,scan_id,scan_date,leaf_area_per_m,plant_area_per_m,"
            "canopy_height_m,canopy_width_m,canopy_base_m,row_gap_share,porosity,"
            "leaf_layer_number,exposed_leaf_share,fruit_zone_area_per_m,fruit_zone_density,block,farm,"
            "variety,longitude,latitude");
  std::getline(lines, line);
  EXPECT_EQ(line,
            "1,0.25,276196.4736,6099944.3249,scan-2019-02-11,2019-02-11,0.03125,0.0625,1.5,0.5,0.75,0,0.25,2,"
            "0.875,0.375,,block a,,Shiraz," +
                place(block.crs, block.scans[0].row_metres[0].position));
}

TEST(PanelProfileCsv, HasALineForEachBandOfThePanelsOfTheBlock) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(1, 2, {"2019-02-11"});
  block.block = "north, \"old\"", block.farm = "Hill";
  const std::string uid = block.panels[1].panel_uid;
  block.scans[0].profile = {{uid, "scan-1", "2019-02-11", 0.8, 1.2, 1.0625, 0.9375},
                            {"of another block", "scan-1", "2019-02-11", 0.8, 1.2, 1, 1},
                            {uid, "scan-1", "2019-02-11", 1.2, 1.6, 2.5, std::nan("")}};
  ASSERT_TRUE(write_panel_profile_csv(block, folder / "p.csv"));
  EXPECT_EQ(read_file(folder / "p.csv"),
            "panel_uid,row_number,panel_number,scan_id,scan_date,height_low_m,height_high_m,plant_area_m2,"
            "leaf_area_m2,block,farm,variety\n" +
                uid + ",1,2,scan-1,2019-02-11,0.8,1.2,1.0625,0.9375,\"north, \"\"old\"\"\",Hill,\n" + uid +
                ",1,2,scan-1,2019-02-11,1.2,1.6,2.5,,\"north, \"\"old\"\"\",Hill,\n");
}

}  // namespace
}  // namespace rayfield::formats
