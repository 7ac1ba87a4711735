#include "formats/geopackage/gpkg_carry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include "rayfield/formats/geopackage.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using ::testing::ElementsAre;
using testing::expect_valid_geopackage;
using testing::make_block;
using testing::message;
using testing::TemporaryFolder;

const std::vector<std::string> kScanIds = {"scan-2018-12-12", "scan-2019-02-11"};

/// A GeoPackage open for writing, as GIS programs have it.
class Editor {
 public:
  explicit Editor(const std::string& path) {
    GDALAllRegister();
    dataset_ = GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE);
  }
  ~Editor() { GDALClose(dataset_); }
  Editor(const Editor&) = delete;
  Editor& operator=(const Editor&) = delete;
  GDALDataset& operator*() const { return *dataset_; }
  GDALDataset* operator->() const { return dataset_; }
  void run(const std::string& sql) const {
    dataset_->ReleaseResultSet(dataset_->ExecuteSQL(sql.c_str(), nullptr, nullptr));
  }
  std::vector<std::string> values(const std::string& sql) const {
    std::vector<std::string> all;
    OGRLayer* rows = dataset_->ExecuteSQL(sql.c_str(), nullptr, nullptr);
    if (rows == nullptr) return all;
    for (auto& row : *rows) all.emplace_back(row->GetFieldAsString(0));
    dataset_->ReleaseResultSet(rows);
    return all;
  }

 private:
  GDALDataset* dataset_ = nullptr;
};

// A layer of points in a CRS that the file does not have yet.
void add_soil_pits(const std::string& path) {
  const Editor editor(path);
  OGRSpatialReference utm;
  utm.SetFromUserInput("EPSG:32754");
  OGRLayer* layer = editor->CreateLayer("soil pits", &utm, wkbPoint, nullptr);
  OGRFieldDefn depth("depth_m", OFTReal);
  ASSERT_EQ(layer->CreateField(&depth), OGRERR_NONE);
  for (int i = 0; i < 5; ++i) {
    OGRFeature pit(layer->GetLayerDefn());
    pit.SetField("depth_m", 0.5 * i);
    const OGRPoint place(276200 + i, 6099950);
    pit.SetGeometry(&place);
    ASSERT_EQ(layer->CreateFeature(&pit), OGRERR_NONE);
  }
}

void add_tables(const std::string& path) {
  const Editor editor(path);
  editor.run("CREATE TABLE \"spray, diary\" (id INTEGER PRIMARY KEY, panel_uid TEXT, litres REAL)");
  editor.run("INSERT INTO \"spray, diary\" VALUES (7, 'panel-1-1', 2.5), (9, 'panel-2-1', NULL)");
  editor.run("CREATE INDEX diary_panel ON \"spray, diary\" (panel_uid)");
  editor.run("CREATE VIEW weak AS SELECT * FROM panel_by_date WHERE leaf_area_per_m < 2");
  editor.run("CREATE TABLE qgis_projects (name TEXT PRIMARY KEY, metadata BLOB, content BLOB)");
  editor.run("INSERT INTO qgis_projects VALUES ('vineyard', x'00ff00', x'504b0304')");
  editor.run(
      "INSERT INTO layer_styles (f_table_catalog, f_table_schema, f_table_name, f_geometry_column, styleName, "
      "styleQML, useAsDefault, owner) VALUES ('', '', 'panel', 'geom', 'mine', '<qgis/>', 1, '')");
}

TEST(GeoPackageCarriesOver, TablesLayersViewsStylesAndProjectsOfUsers) {
  const TemporaryFolder folder;
  const std::string before = folder / "before.gpkg", after = folder / "it's after.gpkg";
  ASSERT_TRUE(write_geopackage(make_block(2, 3, {"2018-12-12"}), before));
  add_soil_pits(before);
  add_tables(before);
  const BlockProducts both = make_block(2, 3, {"2018-12-12", "2019-02-11"});
  EXPECT_TRUE(check_replaceable(both, kScanIds, before)) << message(check_replaceable(both, kScanIds, before));
  EXPECT_TRUE((*inspect_geopackage(before))->has_additions);
  ASSERT_TRUE(write_geopackage(both, after));
  const auto carried = carry_over(before, after);
  ASSERT_TRUE(carried) << message(carried);

  const Editor reader(after);
  EXPECT_THAT(reader.values("SELECT id || ' ' || panel_uid || ' ' || ifnull(litres, '-') FROM \"spray, diary\""),
              ElementsAre("7 panel-1-1 2.5", "9 panel-2-1 -"));
  EXPECT_THAT(reader.values("SELECT hex(content) FROM qgis_projects"), ElementsAre("504B0304"));
  EXPECT_THAT(reader.values("SELECT name FROM sqlite_master WHERE name = 'diary_panel'"), ElementsAre("diary_panel"));
  EXPECT_EQ(reader.values("SELECT count(*) FROM weak"),
            reader.values("SELECT count(*) FROM panel_by_date WHERE leaf_area_per_m < 2"));
  EXPECT_THAT(reader.values("SELECT styleName FROM layer_styles WHERE f_table_name = 'panel' AND useAsDefault = 1"),
              ElementsAre("mine"));
  EXPECT_THAT(reader.values("SELECT count(*) FROM layer_styles WHERE f_table_name = 'post' AND useAsDefault = 1"),
              ElementsAre("1"));
  EXPECT_THAT(reader.values("SELECT count(*) FROM scan"), ElementsAre("2")) << "ours are the new ones";

  OGRLayer* pits = reader->GetLayerByName("soil pits");
  ASSERT_NE(pits, nullptr);
  EXPECT_EQ(pits->GetFeatureCount(), 5);
  EXPECT_STREQ(pits->GetSpatialRef()->GetAuthorityCode(nullptr), "32754");
  pits->SetSpatialFilterRect(276202.5, 6099000, 276300, 6100000);
  EXPECT_EQ(pits->GetFeatureCount(), 2) << "by its spatial index";
  EXPECT_THAT(reader.values("SELECT count(*) FROM \"rtree_soil pits_geom\""), ElementsAre("5"));
}

TEST(GeoPackageCarriesOver, ProjectsOfUsersWhileOursIsMadeAnew) {
  const TemporaryFolder folder;
  const BlockProducts one = make_block(2, 3, {"2018-12-12"}), both = make_block(2, 3, {"2018-12-12", "2019-02-11"});
  GeoPackageOptions options;
  options.project = true;
  ASSERT_TRUE(write_geopackage(one, folder / "0.gpkg", options));
  EXPECT_FALSE((*inspect_geopackage(folder / "0.gpkg"))->has_additions) << "our own project is no addition";
  {
    const Editor editor(folder / "0.gpkg");
    editor.run(
        "INSERT INTO qgis_projects VALUES ('spraying', '{\"last_modified_user\": \"ann\" }', '50'), "
        "('pruning', NULL, '4b')");
    // QGIS's Save, into the project that rayfield wrote.
    editor.run(
        "UPDATE qgis_projects SET content = '5a', metadata = '{\"last_modified_time\": \"2019-03-01T08:00:00\", "
        "\"last_modified_user\": \"ann\" }' WHERE name = 'block a'");
  }
  EXPECT_TRUE((*inspect_geopackage(folder / "0.gpkg"))->has_additions);
  for (int i = 1; i <= 2; ++i) {
    const std::string from = folder / (std::to_string(i - 1) + ".gpkg"), to = folder / (std::to_string(i) + ".gpkg");
    EXPECT_TRUE(check_replaceable(both, kScanIds, from)) << message(check_replaceable(both, kScanIds, from));
    ASSERT_TRUE(write_geopackage(both, to, options));
    const auto carried = carry_over(from, to);
    ASSERT_TRUE(carried) << message(carried);
    const Editor reader(to);
    EXPECT_THAT(reader.values("SELECT name || ' ' || substr(content, 1, 2) FROM qgis_projects ORDER BY name"),
                ElementsAre("block a 50", "block a saved 2019-03-01 08.00.00 5a", "pruning 4b", "spraying 50"));
    EXPECT_THAT(reader.values("SELECT length(content) > 1000 FROM qgis_projects WHERE name = 'block a'"),
                ElementsAre("1"));
  }
  expect_valid_geopackage(folder / "2.gpkg");
}

TEST(GeoPackageCarriesOver, AgainAndAgainAndStaysValid) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(2, 3, {"2018-12-12", "2019-02-11"});
  ASSERT_TRUE(write_geopackage(block, folder / "0.gpkg"));
  add_soil_pits(folder / "0.gpkg");
  for (int i = 1; i <= 3; ++i) {
    const std::string from = folder / (std::to_string(i - 1) + ".gpkg"), to = folder / (std::to_string(i) + ".gpkg");
    EXPECT_TRUE(check_replaceable(block, kScanIds, from)) << message(check_replaceable(block, kScanIds, from));
    ASSERT_TRUE(write_geopackage(block, to));
    const auto carried = carry_over(from, to);
    ASSERT_TRUE(carried) << message(carried);
  }
  expect_valid_geopackage(folder / "3.gpkg");
  // A layer that came over can be edited: its triggers keep the index.
  {
    const Editor editor(folder / "3.gpkg");
    OGRLayer* pits = editor->GetLayerByName("soil pits");
    OGRFeature pit(pits->GetLayerDefn());
    const OGRPoint place(276210, 6099960);
    pit.SetGeometry(&place);
    ASSERT_EQ(pits->CreateFeature(&pit), OGRERR_NONE);
  }
  EXPECT_THAT(Editor(folder / "3.gpkg").values("SELECT count(*) FROM \"rtree_soil pits_geom\""), ElementsAre("6"));
}

TEST(GeoPackageCarriesOver, NothingFromAFileWithoutAdditions) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(2, 3, {"2018-12-12"});
  for (const char* name : {"a.gpkg", "b.gpkg"}) ASSERT_TRUE(write_geopackage(block, folder / name));
  ASSERT_TRUE(carry_over(folder / "a.gpkg", folder / "b.gpkg"));
  EXPECT_FALSE((*inspect_geopackage(folder / "b.gpkg"))->has_additions);
}

}  // namespace
}  // namespace rayfield::formats
