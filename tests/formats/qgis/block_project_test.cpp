#include "formats/qgis/block_project.h"

#include <cpl_minixml.h>
#include <cpl_vsi.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <chrono>
#include <functional>
#include <memory>
#include <set>
#include <thread>

#include "formats/geopackage/gpkg_project.h"
#include "rayfield/formats/geopackage.h"
#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using ::testing::ElementsAre;
using testing::expect_valid_geopackage;
using testing::make_block;
using testing::read_file;
using testing::TemporaryFolder;

using Xml = std::unique_ptr<CPLXMLNode, decltype(&CPLDestroyXMLNode)>;

const std::vector<std::string> kHostileNames = {"<img src=x onerror=alert(1)>", "Böll & \"Söhne\"", "O'Brien's; --",
                                                "]]> &amp; 葡萄"};

GeoPackageOptions with_project(const BlockProducts& block) {
  GeoPackageOptions options;
  options.panel_scale = {0, 5, Ramp::canopy};
  options.project = true;
  for (const ScanResults& scan : block.scans)
    for (const char* product : {"plan_density", "ground"})
      options.maps.push_back({scan.scan.scan_id,
                              product,
                              "m2/m2",
                              block.block + "_" + scan.scan.scan_id + "_" + product + ".tif",
                              {0, 10, Ramp::canopy}});
  return options;
}

// The project's name and text as QGIS finds them in a GeoPackage.
std::pair<std::string, std::string> project_in(const std::string& path) {
  GDALAllRegister();
  GDALDataset* dataset = GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR);
  EXPECT_NE(dataset, nullptr);
  if (dataset == nullptr) return {};
  OGRLayer* rows = dataset->ExecuteSQL("SELECT name, CAST(content AS TEXT) FROM qgis_projects", nullptr, nullptr);
  const std::unique_ptr<OGRFeature> row(rows->GetNextFeature());
  const std::string name = row->GetFieldAsString(0), hex = row->GetFieldAsString(1);
  dataset->ReleaseResultSet(rows);
  GDALClose(dataset);
  int size = 0;
  GByte* bytes = CPLHexToBinary(hex.c_str(), &size);
  const char* archive = "/vsimem/project.zip";
  VSIFCloseL(VSIFileFromMemBuffer(archive, bytes, static_cast<vsi_l_offset>(size), TRUE));
  std::string text;
  if (VSILFILE* file = VSIFOpenL("/vsizip/{/vsimem/project.zip}/project.qgs", "rb")) {
    std::vector<char> part(1 << 16);
    for (std::size_t got; (got = VSIFReadL(part.data(), 1, part.size(), file)) > 0;) text.append(part.data(), got);
    VSIFCloseL(file);
  }
  VSIUnlink(archive);
  return {name, text};
}

Xml parsed(const std::string& text) {
  Xml xml(CPLParseXMLString(text.c_str()), CPLDestroyXMLNode);
  EXPECT_NE(xml, nullptr) << "not well-formed";
  return xml;
}

// Every element of that name, in the order of the document.
std::vector<const CPLXMLNode*> elements(const CPLXMLNode* root, const std::string& name) {
  std::vector<const CPLXMLNode*> found;
  const std::function<void(const CPLXMLNode*)> visit = [&](const CPLXMLNode* node) {
    for (; node != nullptr; node = node->psNext) {
      if (node->eType == CXT_Element && name == node->pszValue) found.push_back(node);
      visit(node->psChild);
    }
  };
  visit(root);
  return found;
}

std::vector<std::string> values(const CPLXMLNode* root, const std::string& element, const char* path) {
  std::vector<std::string> all;
  for (const CPLXMLNode* node : elements(root, element)) all.emplace_back(CPLGetXMLValue(node, path, ""));
  return all;
}

TEST(QgisProject, StandsInTheGeoPackageUnderTheBlocksName) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(2, 3, {"2018-12-12", "2019-02-11"});
  const auto written = write_geopackage(block, folder / "block a.gpkg", with_project(block));
  ASSERT_TRUE(written) << testing::message(written);
  expect_valid_geopackage(folder / "block a.gpkg");
  const auto [name, text] = project_in(folder / "block a.gpkg");
  EXPECT_EQ(name, "block a");
  const Xml xml = parsed(text);
  EXPECT_THAT(values(xml.get(), "layer-tree-group", "name"),
              ElementsAre("", "Rows, panels and posts", "Dates, one at a time", "scan-2019-02-11 name",
                          "scan-2018-12-12 name", "All dates: panels (temporal controller)",
                          "All dates: canopy density (temporal controller)", "Tables"));
  EXPECT_THAT(values(xml.get(), "layer-tree-group", "checked"),
              ElementsAre("", "Qt::Checked", "Qt::Checked", "Qt::Checked", "Qt::Unchecked", "Qt::Unchecked",
                          "Qt::Unchecked", "Qt::Checked"))
      << "the newest date alone is shown";
}

TEST(QgisProject, EveryLayerOfTheTreeIsThereOnceAndItsFileLiesBesideTheProject) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(2, 3, {"2018-12-12", "2019-02-11"});
  ASSERT_TRUE(write_geopackage(block, folder / "b.gpkg", with_project(block)));
  const Xml xml = parsed(project_in(folder / "b.gpkg").second);
  const std::vector<std::string> tree = values(xml.get(), "layer-tree-layer", "id"),
                                 ids = values(xml.get(), "maplayer", "id");
  EXPECT_EQ(tree, ids);
  EXPECT_EQ(std::set(ids.begin(), ids.end()).size(), ids.size());
  for (const std::string& id : ids) EXPECT_GT(id.size(), 10U) << "QGIS would give it another";
  for (const std::string& source : values(xml.get(), "maplayer", "datasource")) {
    EXPECT_TRUE(source.starts_with("./b.gpkg|layername=") || source.starts_with("./block a_scan-")) << source;
  }
  const auto relations = elements(xml.get(), "relation");
  ASSERT_EQ(relations.size(), 1U);
  for (const char* end : {"referencedLayer", "referencingLayer"})
    EXPECT_THAT(ids, ::testing::Contains(CPLGetXMLValue(relations[0], end, "")));
}

TEST(QgisProject, TheTemporalControllerStepsFromDateToDateAndBeginsWithTheNewest) {
  const TemporaryFolder folder;
  const BlockProducts block = make_block(1, 2, {"2018-12-12", "2019-02-11"});
  ASSERT_TRUE(write_geopackage(block, folder / "b.gpkg", with_project(block)));
  const Xml xml = parsed(project_in(folder / "b.gpkg").second);
  EXPECT_THAT(values(xml.get(), "NavigationMode", ""), ElementsAre("1"));
  EXPECT_THAT(values(xml.get(), "StartDateTime", ""), ElementsAre("2019-02-11T00:00:00Z"));
  std::map<std::string, std::string> begins;
  for (const CPLXMLNode* layer : elements(xml.get(), "maplayer"))
    if (const char* begin = CPLGetXMLValue(layer, "temporal.fixedRange.start", nullptr))
      begins[CPLGetXMLValue(layer, "id", "")] = begin;
  const std::map<std::string, std::string> expected = {{"rayfield_season_panels_1", "2018-12-12T00:00:00Z"},
                                                       {"rayfield_season_panels_2", "2019-02-11T00:00:00Z"},
                                                       {"rayfield_season_plan_density_1", "2018-12-12T00:00:00Z"},
                                                       {"rayfield_season_plan_density_2", "2019-02-11T00:00:00Z"}};
  EXPECT_EQ(begins, expected);
}

TEST(QgisProject, HostileNamesStayText) {
  const TemporaryFolder folder;
  for (const std::string& name : kHostileNames) {
    BlockProducts block = make_block(1, 2, {"2019-02-11"});
    block.block = block.farm = block.scans[0].scan.name = name;
    block.scans[0].scan.scan_id = "id '" + name;
    for (PanelValue& value : block.scans[0].panel_values) value.scan_id = block.scans[0].scan.scan_id;
    const auto written = write_geopackage(block, folder / "b.gpkg", with_project(block));
    ASSERT_TRUE(written) << testing::message(written);
    expect_valid_geopackage(folder / "b.gpkg");
    const auto [stored, text] = project_in(folder / "b.gpkg");
    EXPECT_EQ(stored, gpkg::project_name(name));
    EXPECT_EQ(text.find("<img"), std::string::npos);
    const Xml xml = parsed(text);
    EXPECT_EQ(values(xml.get(), "title", ""), (std::vector<std::string>{name + ", " + name}));
    EXPECT_EQ(values(xml.get(), "layer-tree-group", "name")[3], block.scans[0].scan.scan_id + " " + name);
    // A quote in a scan's id is doubled, as SQL wants it.
    std::string literal = "id ''";
    for (const char c : name) literal += c == '\'' ? std::string("''") : std::string(1, c);
    EXPECT_THAT(values(xml.get(), "maplayer", "datasource"),
                ::testing::Contains("./b.gpkg|layername=panel_by_date|subset=\"scan_id\" = '" + literal + "'"));
  }
}

TEST(QgisProject, NamesOfProjectsAreOnesThatQgisCanOpenAgain) {
  EXPECT_EQ(gpkg::project_name("block a-2_b.c"), "block a-2_b.c");
  EXPECT_EQ(gpkg::project_name("Böll & \"Söhne\" 100 %? #1"), "Böll _ _Söhne_ 100 __ _1");
}

TEST(QgisProject, EqualBlocksAreEqualBytesWheneverTheyAreWritten) {
  const TemporaryFolder folder, other;
  const BlockProducts block = make_block(2, 3, {"2018-12-12", "2019-02-11"});
  ASSERT_TRUE(write_geopackage(block, folder / "b.gpkg", with_project(block)));
  std::this_thread::sleep_for(std::chrono::milliseconds(2100));  // ZIP archives count time in steps of two seconds
  ASSERT_TRUE(write_geopackage(block, other / "b.gpkg", with_project(block)));
  EXPECT_TRUE(read_file(folder / "b.gpkg") == read_file(other / "b.gpkg"));
}

TEST(QgisProject, ABlockWithoutScansAndWithoutMapsHasOneToo) {
  const TemporaryFolder folder;
  BlockProducts block = make_block(1, 2, {});
  GeoPackageOptions options;
  options.project = true;
  ASSERT_TRUE(write_geopackage(block, folder / "b.gpkg", options));
  const Xml xml = parsed(project_in(folder / "b.gpkg").second);
  EXPECT_THAT(values(xml.get(), "NavigationMode", ""), ElementsAre());
  EXPECT_EQ(elements(xml.get(), "maplayer").size(), 6U) << "rows, posts, panels and three tables";
}

}  // namespace
}  // namespace rayfield::formats
