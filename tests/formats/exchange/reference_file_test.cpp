#include "rayfield/formats/reference_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include "rayfield/formats/geopackage.h"
#include "rayfield/formats/registry_file.h"
#include "tests/formats/gdal_dataset.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using namespace testing;
using ::testing::HasSubstr;

constexpr const char* kCrs = "EPSG:7854";

std::string file(const TemporaryFolder& folder, const std::string& name, const std::string& content) {
  std::ofstream(folder / name, std::ios::binary) << content;
  return folder / name;
}

void expect_refused(const std::string& path, const std::string& why, ErrorCode code = ErrorCode::bad_input) {
  const auto block = read_reference_file(path, kCrs);
  ASSERT_FALSE(block) << why;
  EXPECT_EQ(block.error().code, code) << block.error().line();
  EXPECT_THAT(block.error().line(), HasSubstr(why));
  EXPECT_FALSE(block.error().next.empty());
}

// A GeoPackage of one layer of lines, in a CRS or in none.
void write_lines(const std::string& path, int epsg, const std::vector<std::vector<Eigen::Vector2d>>& lines) {
  GDALAllRegister();
  OGRSpatialReference crs;
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (epsg > 0) crs.importFromEPSG(epsg);
  const Dataset dataset(
      GetGDALDriverManager()->GetDriverByName("GPKG")->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  OGRLayer* layer = dataset->CreateLayer("vines", epsg > 0 ? &crs : nullptr, wkbMultiLineString);
  OGRFieldDefn number("Row", OFTInteger), name("Name", OFTString);
  layer->CreateField(&number), layer->CreateField(&name);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    OGRFeature feature(layer->GetLayerDefn());
    feature.SetField("Row", static_cast<int>(i) + 11);
    feature.SetField("Name", ("R" + std::to_string(i)).c_str());
    OGRMultiLineString all;
    OGRLineString line;
    for (const Eigen::Vector2d& p : lines[i]) line.addPoint(p.x(), p.y());
    all.addGeometry(&line);
    feature.SetGeometry(&all);
    ASSERT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
  }
}

TEST(ReferenceFile, ReadsLinesOfAGeoPackageInTheStoresCrs) {
  const TemporaryFolder folder;
  write_lines(folder / "rows.gpkg", 7854,
              {{{276200, 6099950}, {276200, 6099980}}, {{276203, 6099950}, {276203, 6099980}}});
  const auto block = read_reference_file(folder / "rows.gpkg", kCrs);
  ASSERT_TRUE(block) << block.error().line();
  ASSERT_EQ(block->rows.size(), 2U);
  EXPECT_EQ(block->rows[1].number, 12);
  EXPECT_EQ(block->rows[1].name, "R1");
  EXPECT_NEAR((block->rows[1].line[1] - Eigen::Vector2d(276203, 6099980)).norm(), 0, 1e-6);
}

// The two zones overlap nowhere on paper, but a point has coordinates in both: the same place must come out.
TEST(ReferenceFile, ReprojectsFromAnotherCrs) {
  const TemporaryFolder folder;
  OGRSpatialReference from, to;
  for (OGRSpatialReference* crs : {&from, &to}) crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  from.importFromEPSG(7854), to.importFromEPSG(7844);  // GDA2020, degrees
  OGRCoordinateTransformation* transform = OGRCreateCoordinateTransformation(&from, &to);
  double x[2] = {276200, 276210}, y[2] = {6099950, 6099990};
  ASSERT_TRUE(transform->Transform(2, x, y));
  OGRCoordinateTransformation::DestroyCT(transform);
  write_lines(folder / "rows.gpkg", 7844, {{{x[0], y[0]}, {x[1], y[1]}}});
  const auto block = read_reference_file(folder / "rows.gpkg", kCrs);
  ASSERT_TRUE(block) << block.error().line();
  EXPECT_NEAR((block->rows[0].line[0] - Eigen::Vector2d(276200, 6099950)).norm(), 0, 1e-3);
  EXPECT_NEAR((block->rows[0].line[1] - Eigen::Vector2d(276210, 6099990)).norm(), 0, 1e-3);
}

TEST(ReferenceFile, ReadsPostsOfACsv) {
  const TemporaryFolder folder;
  const auto map = read_reference_file(
      file(folder, "posts.csv",
           "Row,post,Easting,Northing,diameter_m\n3,1,276200.5,6099950.25,0.1\n3,2,276200.5,6099956.25,\n"
           "\"West, 1\",1,276197.5,6099950,\n"),
      kCrs);
  ASSERT_TRUE(map) << map.error().line();
  ASSERT_EQ(map->posts.size(), 3U);
  EXPECT_EQ(map->posts[0].row_number, 3);
  EXPECT_EQ(map->posts[0].position, Eigen::Vector2d(276200.5, 6099950.25));
  EXPECT_EQ(map->posts[0].diameter_m, 0.1);
  EXPECT_FALSE(map->posts[1].diameter_m);
  EXPECT_FALSE(map->posts[2].row_number);
  EXPECT_EQ(map->posts[2].row_name, "West, 1");

  const auto degrees =
      read_reference_file(file(folder, "degrees.csv", "row,lon,lat\n1,138.55,-35.21\n1,138.55,-35.2101\n"), kCrs);
  ASSERT_TRUE(degrees) << degrees.error().line();
  EXPECT_NEAR((degrees->posts[0].position - degrees->posts[1].position).norm(), 11.1, 0.1);
}

TEST(ReferenceFile, GeoJsonWithoutACrsIsWgs84) {
  const TemporaryFolder folder;
  const auto block = read_reference_file(
      file(folder, "rows.geojson",
           R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"row_number":"7"},)"
           R"("geometry":{"type":"LineString","coordinates":[[138.55,-35.21],[138.55,-35.2103]]}},)"
           R"({"type":"Feature","properties":{"row_number":9,"valid_to":"2020-01-01"},)"
           R"("geometry":{"type":"LineString","coordinates":[[138.56,-35.21],[138.56,-35.2103]]}},)"
           R"({"type":"Feature","properties":{},"geometry":{"type":"Polygon",)"
           R"("coordinates":[[[138,-35],[139,-35],[139,-36],[138,-35]]]}}]})"),
      kCrs);
  ASSERT_TRUE(block) << block.error().line();
  ASSERT_EQ(block->rows.size(), 1U) << "what is gone and what is a polygon is left aside";
  EXPECT_EQ(block->rows[0].number, 7);
}

TEST(ReferenceFile, RefusesWhatIsNotInItsPlace) {
  const TemporaryFolder folder;
  write_lines(folder / "nowhere.gpkg", 0, {{{276200, 6099950}, {276200, 6099980}}});
  expect_refused(folder / "nowhere.gpkg", "does not say in which coordinate reference system");
  // Coordinates of UTM zone 32 in Germany: nothing of Australia's zone 54.
  write_lines(folder / "germany.gpkg", 32632, {{{500000, 5400000}, {500000, 5400030}}});
  expect_refused(folder / "germany.gpkg", "the store's EPSG:7854 is for 138.0 to 144.0");
  // The right numbers under the neighbouring zone's name.
  write_lines(folder / "zone.gpkg", 7855, {{{276200, 6099950}, {276200, 6099980}}});
  expect_refused(folder / "zone.gpkg", "the store's EPSG:7854 is for");
  write_lines(folder / "two.gpkg", 7854,
              {{{276200, 6099950}, {276200, 6099980}}, {{356200, 6099950}, {356200, 6099980}}});
  expect_refused(folder / "two.gpkg", "80 km apart");
  expect_refused(file(folder, "degrees.csv", "row,x,y\n1,138.55,-35.21\n1,138.55,-35.22\n"), "EPSG:7854 is for");
}

TEST(ReferenceFile, RefusesWhatItCannotRead) {
  const TemporaryFolder folder;
  expect_refused(folder / "missing.gpkg", "there is no such file");
  expect_refused(file(folder, "rows.dxf", "x"), "unknown kind of file", ErrorCode::usage);
  expect_refused(file(folder, "rows.gpkg", "no database"), "not a readable GPKG");
  expect_refused(file(folder, "rows.geojson", "{\"type\":\"FeatureCollection\",\"features\":[{"),
                 "not a readable GeoJSON");
  expect_refused(file(folder, "empty.geojson", R"({"type":"FeatureCollection","features":[]})"),
                 "neither lines nor points");
  expect_refused(file(folder, "names.csv", "row,post\n1,1\n"), "it has no coordinates");
  expect_refused(file(folder, "word.csv", "row,easting,northing\n1,276200,6099950\n1,here,6099950\n"), "line 3");
  expect_refused(file(folder, "header.csv", "row,easting,northing\n"), "neither lines nor points");
}

TEST(RegistryFile, ComesBackAsTheReferenceThatItWas) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(3, 4, {});
  block.rows[1].row_name = "Old \"Shiraz\", upper";
  for (std::size_t r = 0; r < block.rows.size(); ++r) {
    PostProduct post;
    post.post_uid = "post-" + std::to_string(r), post.row_number = block.rows[r].row_number;
    post.position = block.rows[r].centreline.front(), post.height_m = 1.9;
    block.posts.push_back(post);
  }
  block.posts.back().valid_to = "2020-01-01";  // gone: not read back
  for (const char* name : {"a.geojson", "a.csv", "a.gpkg"}) {
    const auto written = write_registry_file(block, folder / name);
    ASSERT_TRUE(written) << message(written);
    const auto back = read_reference_file(folder / name, block.crs);
    ASSERT_TRUE(back) << back.error().line();
    ASSERT_EQ(back->rows.size(), 3U) << name;
    EXPECT_EQ(back->rows[1].name, block.rows[1].row_name) << name;
    for (std::size_t r = 0; r < 3; ++r) {
      EXPECT_EQ(back->rows[r].number, block.rows[r].row_number);
      ASSERT_EQ(back->rows[r].line.size(), block.rows[r].centreline.size());
      for (std::size_t i = 0; i < back->rows[r].line.size(); ++i)
        EXPECT_NEAR((back->rows[r].line[i] - block.rows[r].centreline[i]).norm(), 0, 1e-3) << name;
    }
    const std::size_t posts = static_cast<std::size_t>(
        std::count_if(block.posts.begin(), block.posts.end(), [](const auto& p) { return p.valid_to.empty(); }));
    EXPECT_EQ(back->posts.size(), posts) << name;
  }
  EXPECT_EQ(write_registry_file(block, folder / "a.dxf").error().code, ErrorCode::usage);
  expect_valid_geopackage(folder / "a.gpkg");
}

}  // namespace
}  // namespace rayfield::formats
