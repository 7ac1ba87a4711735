#include "rayfield/formats/zone_map.h"

#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <memory>

#include "tests/formats/gdal_dataset.h"
#include "tests/formats/products_support.h"
#include "tests/formats/zones/zone_support.h"

namespace rayfield::formats {
namespace {

using testing::drawn_map;
using testing::message;
using testing::read_file;
using testing::TemporaryFolder;

// Values of a file's zones, as GDAL reads them.
void expect_zones(const std::string& path, const ZoneMap& map, double tolerance) {
  const testing::Dataset dataset = testing::open_dataset(path, GDAL_OF_VECTOR);
  ASSERT_NE(dataset, nullptr) << path;
  OGRLayer* layer = dataset->GetLayer(0);
  ASSERT_EQ(layer->GetFeatureCount(), static_cast<GIntBig>(map.zones.size()));
  std::size_t i = 0;
  for (auto& feature : *layer) {
    const ManagementZone& zone = map.zones[i++];
    EXPECT_EQ(feature->GetFieldAsInteger("zone"), zone.zone);
    EXPECT_NEAR(feature->GetFieldAsDouble("area_m2"), zone.area_m2, tolerance);
    EXPECT_NEAR(feature->GetFieldAsDouble("area_ha"), zone.area_m2 / 1e4, tolerance);
    EXPECT_NEAR(feature->GetFieldAsDouble("mean"), zone.mean, tolerance);
    EXPECT_NEAR(feature->GetFieldAsDouble("max"), zone.max, tolerance);
    const int low = feature->GetFieldIndex("class_low");
    EXPECT_EQ(feature->IsFieldSetAndNotNull(low) != 0, std::isfinite(zone.low)) << "an open class has no bound";
    EXPECT_EQ(feature->GetFieldAsString("block"), map.block);
    EXPECT_EQ(feature->GetFieldAsString("farm"), map.farm);
    ASSERT_NE(feature->GetGeometryRef(), nullptr);
    EXPECT_TRUE(feature->GetGeometryRef()->IsValid());
  }
}

TEST(ZoneFiles, ReadBackWithTheirValues) {
  const TemporaryFolder folder;
  ZoneMap map = drawn_map(60);
  map.block = "Böll & \"Söhne\", Nord", map.farm = "<img onerror=alert(1)>";
  map.zones[1].mean = 2.5, map.zones[1].max = 1.0 / 3;
  ASSERT_TRUE(write_zones_geopackage(map, folder / "z.gpkg"));
  ASSERT_TRUE(write_zones_geojson(map, folder / "z.geojson"));
  ASSERT_TRUE(write_zones_shapefile(map, {}, *find_farm_profile("plain"), folder / "z.shp.zip"));
  expect_zones(folder / "z.gpkg", map, 0);
  expect_zones(folder / "z.geojson", map, 0);
  expect_zones(folder / "z.shp.zip", map, 5.1e-7);
  testing::expect_valid_geopackage(folder / "z.gpkg");
}

TEST(ZoneFiles, TheLegendNamesEachZoneWithItsMean) {
  const TemporaryFolder folder;
  ZoneMap map = drawn_map(60);
  for (ManagementZone& zone : map.zones) zone.mean = 1.25 * zone.zone;
  ASSERT_TRUE(write_zones_geopackage(map, folder / "z.gpkg"));
  const testing::Dataset dataset = testing::open_dataset(folder / "z.gpkg", GDAL_OF_VECTOR);
  ASSERT_NE(dataset, nullptr);
  OGRLayer* styles = dataset->ExecuteSQL("SELECT styleQML FROM layer_styles", nullptr, nullptr);
  ASSERT_NE(styles, nullptr);
  const std::unique_ptr<OGRFeature> style(styles->GetNextFeature());
  ASSERT_NE(style, nullptr);
  const std::string qml = style->GetFieldAsString(0);
  for (const char* label : {"zone 1, mean 1.25 m²/m", "zone 2, mean 2.50 m²/m", "zone 3, mean 3.75 m²/m"})
    EXPECT_NE(qml.find(label), std::string::npos) << label;
  dataset->ReleaseResultSet(styles);
}

TEST(ZoneFiles, EqualInputGivesEqualBytes) {
  const TemporaryFolder folder;
  const ZoneMap map = drawn_map(60), again = drawn_map(60);
  ASSERT_TRUE(write_zones_geopackage(map, folder / "a.gpkg"));
  ASSERT_TRUE(write_zones_geopackage(again, folder / "b.gpkg"));
  EXPECT_EQ(read_file(folder / "a.gpkg"), read_file(folder / "b.gpkg"));
}

TEST(ZoneFiles, APrescriptionCarriesItsRates) {
  const TemporaryFolder folder;
  const ZoneMap map = drawn_map(60);
  const Prescription rates{"Kupfer, \"flüssig\"", "l/ha", {150, 225.5, 300}};
  for (const FarmProfile& profile : farm_profiles()) {
    SCOPED_TRACE(profile.name);
    const auto written = write_zones_shapefile(map, rates, profile, folder / "p.zip");
    ASSERT_TRUE(written) << message(written);
    const std::string archive = "/vsizip/" + folder / "p.zip" + (profile.folder.empty() ? "" : "/Rx");
    const testing::Dataset dataset = testing::open_dataset(archive, GDAL_OF_VECTOR);
    ASSERT_NE(dataset, nullptr);
    std::size_t i = 0;
    for (auto& feature : *dataset->GetLayer(0)) EXPECT_EQ(feature->GetFieldAsDouble("rate"), rates.rates[i++]);
    EXPECT_EQ(i, 3U);
  }
}

}  // namespace
}  // namespace rayfield::formats
