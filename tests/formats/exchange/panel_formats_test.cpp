#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <set>

#include "formats/exchange/panel_table.h"
#include "formats/gis/vector_file.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/formats/exchange.h"
#include "tests/formats/gdal_dataset.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using testing::kNan;
using testing::make_block;
using testing::message;
using testing::read_file;
using testing::TemporaryFolder;

constexpr const char* kHostile = "<img onerror=alert(1)> & Böll \"Söhne\", Nord";

// Two rows of two panels on two dates, with names and values that formats like to trip over.
BlockProducts hostile_block() {
  BlockProducts block = make_block(2, 2, {"2018-12-12", "2019-02-11"});
  block.block = "Böll & \"Söhne\", Nord", block.farm = kHostile, block.variety = "=1+1";
  block.snapshot = 7;
  std::vector<PanelValue>& values = block.scans[1].panel_values;
  values[0].lai = kNan;
  values[1].leaf_area_per_m = kNan;
  values[2].leaf_area_m2 = -0.1 - 0.2;
  values[2].wood_scan_id = "winter", values[2].wood_from = kWoodFromDormantScan;
  return block;
}

// Column names as a format has them; values within what its numbers hold.
struct Reading {
  std::string path;
  bool short_names = false;
  double tolerance = 0;
};

const VectorColumn& column_of(const std::vector<VectorColumn>& columns, const std::string& name) {
  for (const VectorColumn& column : columns)
    if (column.name == name) return column;
  throw std::runtime_error("no column " + name);
}

void expect_text(OGRFeature& feature, const std::string& column, const std::string& expected) {
  ASSERT_GE(feature.GetFieldIndex(column.c_str()), 0) << column;
  EXPECT_EQ(feature.GetFieldAsString(column.c_str()), expected) << column;
}

void expect_number(OGRFeature& feature, const std::string& column, double expected, double tolerance) {
  const int index = feature.GetFieldIndex(column.c_str());
  ASSERT_GE(index, 0) << column;
  EXPECT_EQ(feature.IsFieldSetAndNotNull(index) != 0, std::isfinite(expected)) << column;
  if (!std::isfinite(expected)) return;
  EXPECT_NEAR(feature.GetFieldAsDouble(index), expected, tolerance) << column;
}

void expect_place(OGRFeature& feature, const BlockProducts& block, const PanelProduct& panel) {
  const OGRGeometry* geometry = feature.GetGeometryRef();
  ASSERT_NE(geometry, nullptr);
  const OGRPolygon* polygon = geometry->getGeometryType() == wkbMultiPolygon
                                  ? geometry->toMultiPolygon()->getGeometryRef(0)
                                  : geometry->toPolygon();
  OGRPoint centre;
  ASSERT_EQ(polygon->Centroid(&centre), OGRERR_NONE);
  const Eigen::Vector2d middle = (panel.outline[0] + panel.outline[2]) / 2;
  const auto frame = MapFrame::create(block.crs);
  const Eigen::Vector3d expected = frame->geodetic_from_map({middle.x(), middle.y(), 0});
  EXPECT_NEAR(centre.getX(), expected.y(), 1e-8);
  EXPECT_NEAR(centre.getY(), expected.x(), 1e-8);
}

// Reads the second scan of the block with GDAL and holds it against what went in.
void expect_reads_back(const BlockProducts& block, const Reading& reading) {
  const testing::Dataset dataset = testing::open_dataset(reading.path, GDAL_OF_VECTOR);
  ASSERT_NE(dataset, nullptr) << reading.path;
  ASSERT_EQ(dataset->GetLayerCount(), 1);
  OGRLayer* layer = dataset->GetLayer(0);
  ASSERT_EQ(layer->GetFeatureCount(), static_cast<GIntBig>(block.panels.size()));
  const std::vector<VectorColumn> columns = panel_columns();
  const auto name = [&](const std::string& column) {
    return reading.short_names ? column_of(columns, column).short_name : column;
  };
  std::set<std::string> seen;
  for (auto& feature : *layer) {
    const std::string uid = feature->GetFieldAsString(name("panel_uid").c_str());
    seen.insert(uid);
    std::size_t i = 0;
    while (i < block.panels.size() && block.panels[i].panel_uid != uid) ++i;
    ASSERT_LT(i, block.panels.size()) << uid;
    const PanelValue& value = block.scans[1].panel_values[i];
    expect_text(*feature, name("block"), block.block);
    expect_text(*feature, name("farm"), block.farm);
    expect_text(*feature, name("variety"), block.variety);
    expect_text(*feature, name("wood_scan_id"), value.wood_scan_id);
    expect_text(*feature, name("wood_from"), value.wood_from);
    expect_number(*feature, name("row_number"), block.panels[i].row_number, 0);
    expect_number(*feature, name("lai"), value.lai, reading.tolerance);
    expect_number(*feature, name("leaf_area_m2"), value.leaf_area_m2, reading.tolerance);
    expect_number(*feature, name("leaf_area_per_m"), value.leaf_area_per_m, reading.tolerance);
    expect_number(*feature, name("se_plant_area_m2"), value.se_plant_area_m2, reading.tolerance);
    expect_number(*feature, name("plant_ci_low_m2"), value.plant_ci_low_m2, reading.tolerance);
    expect_number(*feature, name("plant_ci_high_m2"), value.plant_ci_high_m2, reading.tolerance);
    expect_number(*feature, name("ray_count"), static_cast<double>(value.ray_count), 0);
    int year = 0, month = 0, day = 0, ignored = 0;
    if (feature->GetFieldAsDateTime(feature->GetFieldIndex(name("scan_date").c_str()), &year, &month, &day, &ignored,
                                    &ignored, &ignored, &ignored) != 0)
      EXPECT_EQ(std::make_tuple(year, month, day), std::make_tuple(2019, 2, 11));
    else
      expect_text(*feature, name("scan_date"), "2019-02-11");
    expect_place(*feature, block, block.panels[i]);
  }
  EXPECT_EQ(seen.size(), block.panels.size());
}

struct Case {
  PanelFormat format;
  const char* name;
  double tolerance = 0;
};
constexpr Case kCases[] = {{PanelFormat::geojson, "a.geojson"},
                           {PanelFormat::kml, "a.kml", 1e-13},
                           {PanelFormat::flatgeobuf, "a.fgb"},
                           {PanelFormat::geoparquet, "a.parquet"}};

TEST(PanelFormats, HostileNamesNullsAndValuesReadBackFromEveryFormat) {
  const TemporaryFolder folder;
  const BlockProducts block = hostile_block();
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.name);
    if (!check_panel_format(c.format, c.name)) continue;  // the next test says what is refused then
    const auto written = write_panels(block, 1, c.format, folder / c.name);
    ASSERT_TRUE(written) << message(written);
    expect_reads_back(block, {folder / c.name, false, c.tolerance});
  }
}

TEST(PanelFormats, AFormatWithoutDriverIsRefusedWithOneLine) {
  const VectorFormat missing{"NoSuchDriver", ".x"};
  const auto checked = check_driver(missing, "cannot write X", "a.x");
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::usage);
  EXPECT_EQ(checked.error().line().find('\n'), std::string::npos);
  EXPECT_NE(checked.error().line().find("NoSuchDriver"), std::string::npos);
}

TEST(PanelFormats, EqualInputGivesEqualBytes) {
  const TemporaryFolder folder;
  const BlockProducts block = hostile_block();
  for (const Case& c : kCases) {
    if (!check_panel_format(c.format, c.name)) continue;
    ASSERT_TRUE(write_panels(block, 1, c.format, folder / c.name));
    const std::string first = read_file(folder / c.name);
    ASSERT_TRUE(write_panels(block, 1, c.format, folder / c.name));
    EXPECT_EQ(read_file(folder / c.name), first) << c.name;
  }
  for (const FarmProfile& profile : farm_profiles()) {
    ASSERT_TRUE(write_panels_shapefile(block, 1, profile, folder / "a.zip"));
    const std::string first = read_file(folder / "a.zip");
    ::sleep(2);  // a ZIP archive keeps times to two seconds
    ASSERT_TRUE(write_panels_shapefile(block, 1, profile, folder / "a.zip"));
    EXPECT_EQ(read_file(folder / "a.zip"), first) << profile.name;
  }
}

TEST(PanelFormats, APanelWithoutOutlineDoesNotKeepTheOthersFromBeingWritten) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(1, 2, {"2019-02-11"});
  block.panels[0].outline.clear();
  for (const Case& c : kCases) {
    if (!check_panel_format(c.format, c.name)) continue;
    const auto written = write_panels(block, 0, c.format, folder / c.name);
    EXPECT_TRUE(written) << c.name << ": " << message(written);
  }
  const auto written = write_panels_shapefile(block, 0, farm_profiles()[0], folder / "a.shp.zip");
  EXPECT_TRUE(written) << message(written);
}

TEST(Shapefile, ReadsBackWithShortNamesUtf8AndWgs84) {
  const TemporaryFolder folder;
  const BlockProducts block = hostile_block();
  const auto written = write_panels_shapefile(block, 1, *find_farm_profile("plain"), folder / "a.shp.zip");
  ASSERT_TRUE(written) << message(written);
  expect_reads_back(block, {folder / "a.shp.zip", true, 5.1e-7});
  const testing::Dataset dataset = testing::open_dataset(folder / "a.shp.zip", GDAL_OF_VECTOR);
  ASSERT_NE(dataset, nullptr);
  const OGRSpatialReference* crs = dataset->GetLayer(0)->GetSpatialRef();
  ASSERT_NE(crs, nullptr);
  EXPECT_STREQ(crs->GetAuthorityCode(nullptr), "4326");
  EXPECT_EQ(dataset->GetLayer(0)->GetLayerDefn()->GetFieldCount(), static_cast<int>(panel_columns().size()));
}

TEST(Shapefile, ShortNamesAreUniqueAndOfTenCharactersAtMost) {
  std::set<std::string> names;
  for (const VectorColumn& column : panel_columns()) {
    EXPECT_LE(column.short_name.size(), 10U) << column.name;
    EXPECT_TRUE(names.insert(column.short_name).second) << column.short_name;
    EXPECT_FALSE(column.meaning.empty()) << column.name;
  }
}

// Names of the members of an archive, as GDAL sees them.
std::set<std::string> members(const std::string& path) {
  std::set<std::string> names;
  char** list = VSIReadDirRecursive(("/vsizip/" + path).c_str());
  for (int i = 0; list != nullptr && list[i] != nullptr; ++i) names.insert(list[i]);
  CSLDestroy(list);
  return names;
}

TEST(FarmProfiles, HoldTheRulesOfTheirSystems) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(2, 2, {"2019-02-11"});
  block.block = "Süd 1";
  const std::string stem = "S_d_1_scan-2019-02-11_panels";
  const auto write = [&](const char* profile) {
    const auto written = write_panels_shapefile(block, 0, *find_farm_profile(profile), folder / "a.zip");
    EXPECT_TRUE(written) << message(written);
    return members(folder / "a.zip");
  };
  EXPECT_EQ(write("plain"), (std::set<std::string>{stem + ".cpg", stem + ".dbf", stem + ".prj", stem + ".shp",
                                                   stem + ".shx", stem + "_fields.csv"}));
  EXPECT_EQ(write("fieldview"), (std::set<std::string>{stem + ".dbf", stem + ".shp", stem + ".shx"}));
  EXPECT_TRUE(write("deere").count("Rx/" + stem + ".shp") > 0);
  write("geopard");
  const testing::Dataset dataset = testing::open_dataset("/vsizip/" + folder / "a.zip", GDAL_OF_VECTOR);
  ASSERT_NE(dataset, nullptr);
  const OGRFeatureDefn* definition = dataset->GetLayer(0)->GetLayerDefn();
  EXPECT_EQ(definition->GetFieldCount(), 20);
  EXPECT_GE(definition->GetFieldIndex("leaf_per_m"), 0) << "the first columns are kept";
  for (int i = 0; i < definition->GetFieldCount(); ++i)
    EXPECT_NE(definition->GetFieldDefn(i)->GetType(), OFTString) << definition->GetFieldDefn(i)->GetNameRef();
}

TEST(FarmProfiles, ASystemThatTakesFewerPolygonsRefusesTheBlock) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(11, 10, {"2019-02-11"});
  const auto written = write_panels_shapefile(block, 0, *find_farm_profile("fieldview"), folder / "a.zip");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::usage);
  EXPECT_NE(written.error().why.find("110"), std::string::npos) << written.error().line();
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace rayfield::formats
