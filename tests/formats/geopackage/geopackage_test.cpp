#include "rayfield/formats/geopackage.h"

#include <cpl_minixml.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <map>
#include <memory>
#include <set>

#include "tests/formats/geopackage/geopackage_reader.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using testing::expect_valid_geopackage;
using testing::GeopackageReader;
using testing::kNan;
using testing::make_block;
using testing::message;
using testing::read_file;
using testing::TemporaryFolder;

const std::vector<std::string> kTwoDates = {"2018-12-12", "2019-02-11"};

TEST(GeoPackage, PassesTheValidatorWithAndWithoutContent) {
  const TemporaryFolder folder;
  std::vector<std::string> many_dates;
  for (int month = 1; month <= 12; ++month) {
    for (const int day : {1, 9, 17, 25}) {
      many_dates.push_back("2019-" + std::string(month < 10 ? "0" : "") + std::to_string(month) + "-" +
                           (day < 10 ? "0" : "") + std::to_string(day));
    }
  }
  BlockProducts no_scan = make_block(2, 3, {});
  BlockProducts nothing;
  nothing.crs = "EPSG:7854";
  const std::vector<std::pair<std::string, BlockProducts>> cases = {{"usual", make_block(3, 4, kTwoDates)},
                                                                    {"one_row", make_block(1, 1, {"2019-02-11"})},
                                                                    {"many_dates", make_block(2, 2, many_dates)},
                                                                    {"no_scan", no_scan},
                                                                    {"nothing", nothing}};
  for (const auto& [name, block] : cases) {
    const std::string path = folder / (name + ".gpkg");
    const auto written = write_geopackage(block, path);
    ASSERT_TRUE(written) << name << ": " << message(written);
    expect_valid_geopackage(path);
  }
}

TEST(GeoPackage, ValuesComeBackExactlyAndNanIsNull) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(2, 3, kTwoDates);
  PanelValue& first = block.scans[1].panel_values[0];
  first.leaf_area_m2 = 0.1 + 0.2;  // needs all 17 digits
  first.lai = kNan;
  first.wood_scan_id = "scan-2018-12-12", first.wood_from = kWoodFromDormantScan;
  block.scans[0].scan.wood_from = kWoodFromEstimate;
  block.scans[0].scan.leaf_note = "dormant";
  block.scans[0].scan.fruit_zone_low_m = 0.75;
  first.descriptors.exposed_leaf_share = kNan;
  ASSERT_TRUE(write_geopackage(block, folder / "a.gpkg"));
  const GeopackageReader reader(folder / "a.gpkg");
  OGRLayer* values = reader.layer("panel_value");
  values->SetAttributeFilter("panel_uid = 'panel-1-1' AND scan_id = 'scan-2019-02-11'");
  const std::unique_ptr<OGRFeature> row(values->GetNextFeature());
  ASSERT_NE(row, nullptr);
  const auto real = [&row](const char* name) { return row->GetFieldAsDouble(name); };
  EXPECT_EQ(real("leaf_area_m2"), 0.1 + 0.2);
  EXPECT_TRUE(row->IsFieldNull(row->GetFieldIndex("lai")));
  EXPECT_EQ(real("leaf_area_per_m"), 1.875);
  EXPECT_EQ(real("plant_area_m2"), 1.875 * 6.5 + 2);
  EXPECT_EQ(real("se_leaf_area_m2"), 0.25);
  EXPECT_EQ(real("ci_low_m2"), 1.875 * 6.5 - 0.5);
  EXPECT_EQ(real("ci_high_m2"), 1.875 * 6.5 + 0.5);
  EXPECT_EQ(real("canopy_height_m"), 1.75);
  EXPECT_EQ(real("canopy_width_m"), 0.625);
  EXPECT_EQ(real("gap_fraction"), 0.375);
  EXPECT_EQ(real("observed_fraction"), 0.9375);
  EXPECT_EQ(row->GetFieldAsInteger64("ray_count"), 5'000'000'000LL);
  EXPECT_EQ(values->GetLayerDefn()->GetFieldDefn(row->GetFieldIndex("scan_date"))->GetType(), OFTDate);
  EXPECT_STREQ(row->GetFieldAsString("scan_date"), "2019/02/11");
  EXPECT_EQ(real("se_plant_area_m2"), 0.1875);
  EXPECT_EQ(real("plant_ci_low_m2"), 1.875 * 6.5 + 2 - 0.375);
  EXPECT_EQ(real("plant_ci_high_m2"), 1.875 * 6.5 + 2 + 0.375);
  EXPECT_STREQ(row->GetFieldAsString("wood_scan_id"), "scan-2018-12-12");
  EXPECT_EQ(reader.value("SELECT count(*) FROM panel_value WHERE wood_scan_id IS NULL"), "11") << "none, not ''";
  EXPECT_STREQ(row->GetFieldAsString("wood_from"), "dormant scan");
  EXPECT_EQ(reader.value("SELECT count(*) FROM panel_value WHERE wood_from IS NULL"), "11");
  EXPECT_EQ(reader.value("SELECT wood_from FROM scan WHERE scan_id = 'scan-2018-12-12'"), "estimate");
  EXPECT_EQ(real("canopy_base_m"), 0.875);
  EXPECT_EQ(real("porosity"), 0.1875);
  EXPECT_EQ(real("leaf_layer_number"), 2.5);
  EXPECT_TRUE(row->IsFieldNull(row->GetFieldIndex("exposed_leaf_share")));
  EXPECT_EQ(real("fruit_zone_density"), 2.25);
  EXPECT_EQ(reader.value("SELECT fruit_zone_low_m FROM scan WHERE scan_id = 'scan-2018-12-12'"), "0.75");
  EXPECT_EQ(reader.value("SELECT fruit_zone_high_m FROM scan WHERE scan_id = 'scan-2018-12-12'"), "NULL");
  EXPECT_EQ(reader.value("SELECT count(*) FROM panel_profile"), std::to_string(2 * 6 * 2));
  EXPECT_EQ(reader.value("SELECT leaf_area_m2 FROM panel_profile WHERE panel_uid = 'panel-1-1' AND scan_id = "
                         "'scan-2018-12-12' AND height_high_m = 1.25"),
            "5.6875");
  EXPECT_EQ(reader.value("SELECT count(*) FROM row_metre WHERE canopy_height_m = 1.5 AND leaf_layer_number = 2 AND "
                         "fruit_zone_density IS NULL"),
            std::to_string(2 * 2 * 39));
  EXPECT_EQ(reader.value("SELECT leaf_note FROM scan WHERE leaf_note IS NOT NULL"), "dormant");
  EXPECT_EQ(reader.value("SELECT scan_date FROM scan WHERE scan_id = 'scan-2018-12-12'"), "2018/12/12");
  EXPECT_EQ(reader.value("SELECT CAST(end_utc AS TEXT) FROM scan WHERE scan_id = 'scan-2018-12-12'"),
            "2018-12-12T01:02:03.004Z");
  EXPECT_EQ(reader.value("SELECT count(*) FROM row_metre"), std::to_string(2 * 2 * 39));
}

TEST(GeoPackage, GeometriesComeBackExactly) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(2, 3, kTwoDates);
  ASSERT_TRUE(write_geopackage(block, folder / "a.gpkg"));
  const GeopackageReader reader(folder / "a.gpkg");
  const std::unique_ptr<OGRFeature> panel(reader.layer("panel")->GetFeature(2));
  const OGRLinearRing* ring = panel->GetGeometryRef()->toPolygon()->getExteriorRing();
  ASSERT_EQ(ring->getNumPoints(), 5);
  EXPECT_FALSE(ring->isClockwise());
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(ring->getX(i), block.panels[1].outline[static_cast<std::size_t>(i)].x());
    EXPECT_EQ(ring->getY(i), block.panels[1].outline[static_cast<std::size_t>(i)].y());
  }
  EXPECT_EQ(ring->getX(4), ring->getX(0));
  const std::unique_ptr<OGRFeature> post(reader.layer("post")->GetFeature(2));
  EXPECT_EQ(post->GetGeometryRef()->toPoint()->getX(), block.posts[1].position.x());
  EXPECT_EQ(post->GetFieldAsInteger("detected"), 0);
  const std::unique_ptr<OGRFeature> row(reader.layer("vine_row")->GetFeature(2));
  EXPECT_EQ(row->GetGeometryRef()->toLineString()->getY(1), block.rows[1].centreline[1].y());
}

TEST(GeoPackage, TheViewJoinsEachPanelWithEachOfItsDates) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(3, 4, kTwoDates);
  block.scans[0].panel_values.erase(block.scans[0].panel_values.begin());  // one panel was not scanned
  ASSERT_TRUE(write_geopackage(block, folder / "a.gpkg"));
  const GeopackageReader reader(folder / "a.gpkg");
  OGRLayer* view = reader.layer("panel_by_date");
  ASSERT_NE(view, nullptr);
  EXPECT_EQ(view->GetFeatureCount(), 23);
  EXPECT_STREQ(view->GetFIDColumn(), "OGC_FID");
  std::set<GIntBig> ids;
  for (auto& feature : *view) {
    ids.insert(feature->GetFID());
    const int row = feature->GetFieldAsInteger("row_number"), panel = feature->GetFieldAsInteger("panel_number");
    const double date = std::string(feature->GetFieldAsString("scan_date")) == "2019/02/11" ? 0.125 : 0.0;
    EXPECT_EQ(feature->GetFieldAsDouble("leaf_area_per_m"), 1.25 * row + 0.5 * panel + date);
    ASSERT_NE(feature->GetGeometryRef(), nullptr);
    EXPECT_NEAR(feature->GetGeometryRef()->toPolygon()->get_Area(), 6.5, 1e-6);
  }
  EXPECT_EQ(ids.size(), 23U);
  EXPECT_EQ(reader.value("SELECT leaf_area_per_m_2018_12_12 FROM panel_wide WHERE panel_uid = 'panel-1-1'"), "NULL");
  EXPECT_EQ(reader.value("SELECT leaf_area_per_m_2019_02_11 FROM panel_wide WHERE panel_uid = 'panel-1-1'"), "1.875");
}

TEST(GeoPackage, SpatialLayersAreIndexed) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_geopackage(make_block(2, 3, kTwoDates), folder / "a.gpkg"));
  const GeopackageReader reader(folder / "a.gpkg");
  for (const char* table : {"vine_row", "panel", "post", "row_metre", "panel_wide"}) {
    EXPECT_EQ(reader.value("SELECT count(*) FROM rtree_" + std::string(table) + "_geom"),
              reader.value("SELECT count(*) FROM " + std::string(table)))
        << table;
  }
}

TEST(GeoPackage, EqualProductsAreEqualBytesAndTimesComeFromTheScans) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(3, 4, kTwoDates);
  ASSERT_TRUE(write_geopackage(block, folder / "a.gpkg"));
  const std::string reference = read_file(folder / "a.gpkg");
  ASSERT_TRUE(write_geopackage(block, folder / "other name.gpkg"));
  EXPECT_TRUE(read_file(folder / "other name.gpkg") == reference);
  ASSERT_TRUE(write_geopackage(block, folder / "a.gpkg"));
  EXPECT_TRUE(read_file(folder / "a.gpkg") == reference);
  const GeopackageReader reader(folder / "a.gpkg");
  EXPECT_EQ(reader.rows("SELECT DISTINCT CAST(last_change AS TEXT) FROM gpkg_contents"),
            (std::vector<std::vector<std::string>>{{"2019-02-11T01:02:03.004Z"}}));
  EXPECT_EQ(reader.rows("SELECT DISTINCT CAST(update_time AS TEXT) FROM layer_styles"),
            (std::vector<std::vector<std::string>>{{"2019-02-11T01:02:03.004Z"}}));
}

/// Class limits of a graduated style.
std::vector<std::pair<double, double>> class_limits(const std::string& qml) {
  std::vector<std::pair<double, double>> limits;
  CPLXMLNode* root = CPLParseXMLString(qml.c_str());
  const CPLXMLNode* ranges = CPLSearchXMLNode(root, "=ranges");
  for (const CPLXMLNode* node = ranges == nullptr ? nullptr : ranges->psChild; node != nullptr; node = node->psNext) {
    limits.emplace_back(CPLAtof(CPLGetXMLValue(node, "lower", "nan")), CPLAtof(CPLGetXMLValue(node, "upper", "nan")));
  }
  CPLDestroyXMLNode(root);
  return limits;
}

TEST(GeoPackage, EverySpatialLayerHasADefaultStyleAndPanelsHaveFixedClasses) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(2, 3, kTwoDates);
  ASSERT_TRUE(write_geopackage(block, folder / "a.gpkg"));
  for (PanelValue& value : block.scans[1].panel_values) value.leaf_area_per_m *= 0.1;
  ASSERT_TRUE(write_geopackage(block, folder / "b.gpkg"));
  const GeopackageReader a(folder / "a.gpkg"), b(folder / "b.gpkg");
  for (const char* table : {"vine_row", "panel", "post", "row_metre", "panel_by_date", "panel_wide"}) {
    // QGIS looks for an empty schema, not for NULL.
    const std::string where = " FROM layer_styles WHERE f_table_schema = '' AND f_table_name = '" + std::string(table) +
                              "' AND f_geometry_column = 'geom' AND useAsDefault = 1";
    EXPECT_EQ(a.value("SELECT count(*)" + where), "1") << table;
    CPLXMLNode* root = CPLParseXMLString(a.value("SELECT styleQML" + where).c_str());
    EXPECT_NE(root, nullptr) << table;
    CPLDestroyXMLNode(root);
  }
  const std::string style = "SELECT styleQML FROM layer_styles WHERE f_table_name = 'panel_by_date'";
  EXPECT_NE(a.value(style).find("attr=\"leaf_area_per_m\""), std::string::npos);
  const auto limits = class_limits(a.value(style));
  ASSERT_EQ(limits.size(), 13U);
  EXPECT_EQ(limits[0].second, 0.06) << "nothing, without fill";
  EXPECT_EQ(limits[4], std::pair(1.5, 2.0));  // 0 … 6 m²/m in twelve classes
  EXPECT_EQ(limits, class_limits(b.value(style)));
}

TEST(GeoPackage, TextFromUsersIsKeptLetterForLetter) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(1, 2, {"2019-02-11"});
  const std::string name = "O'Brien's \"best\" <b>&amp; Grüner 葡萄; DROP TABLE panel; --";
  block.scans[0].scan.name = name;
  block.scans[0].scan.scan_id = "id '\" <";
  for (PanelValue& value : block.scans[0].panel_values) value.scan_id = "id '\" <";
  ASSERT_TRUE(write_geopackage(block, folder / "a'b.gpkg"));
  const GeopackageReader reader(folder / "a'b.gpkg");
  EXPECT_EQ(reader.value("SELECT name FROM scan"), name);
  EXPECT_EQ(reader.value("SELECT scan_id FROM panel_by_date"), "id '\" <");
  block.scans[0].scan.name = "bad \xff\xfe bytes\nand a line";
  ASSERT_TRUE(write_geopackage(block, folder / "c.gpkg"));
  const GeopackageReader repaired(folder / "c.gpkg");
  EXPECT_EQ(repaired.value("SELECT name FROM scan"), "bad \xEF\xBF\xBD\xEF\xBF\xBD bytes and a line");
  expect_valid_geopackage(folder / "c.gpkg");
}

TEST(GeoPackage, ASecondScanOfOneDateGetsAColumnOfItsOwn) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(1, 2, {"2019-02-11", "2019-02-11"});
  block.scans[1].scan.scan_id = "second";
  for (PanelValue& value : block.scans[1].panel_values) value.scan_id = "second";
  ASSERT_TRUE(write_geopackage(block, folder / "a.gpkg"));
  const GeopackageReader reader(folder / "a.gpkg");
  EXPECT_EQ(reader.value("SELECT leaf_area_per_m_2019_02_11_2 FROM panel_wide WHERE panel_uid = 'panel-1-1'"), "1.875");
}

TEST(GeoPackage, WrongInputIsRefusedAndTheOldFileStays) {
  const TemporaryFolder folder;
  const BlockProducts good = make_block(2, 3, kTwoDates);
  ASSERT_TRUE(write_geopackage(good, folder / "a.gpkg"));
  const std::string before = read_file(folder / "a.gpkg");
  const auto code = [&folder](const BlockProducts& block) {
    const auto written = write_geopackage(block, folder / "a.gpkg");
    return written ? ErrorCode{} : written.error().code;
  };
  BlockProducts block = good;
  block.crs = "EPSG:99999";
  EXPECT_EQ(code(block), ErrorCode::usage);
  block = good;
  block.scans[0].scan.scan_date = "2019-02-30";
  EXPECT_EQ(code(block), ErrorCode::usage);
  block = good;
  block.panels[1].panel_uid = block.panels[0].panel_uid;
  EXPECT_EQ(code(block), ErrorCode::internal);
  block = good;
  block.panels[1].outline[0].x() = kNan;
  EXPECT_EQ(code(block), ErrorCode::internal);
  block = good;
  block.posts[0].position.y() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(code(block), ErrorCode::internal);
  EXPECT_TRUE(read_file(folder / "a.gpkg") == before);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.gpkg"});
}

}  // namespace
}  // namespace rayfield::formats
