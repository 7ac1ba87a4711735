#include "rayfield/formats/stac.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/formats/products_support.h"

namespace rayfield::formats {
namespace {

using nlohmann::json;
using testing::message;
using testing::read_file;
using testing::TemporaryFolder;

constexpr const char* kCollection = "block_collection.json";

BlockProducts block_named(const std::string& name, const std::string& crs = "EPSG:7854") {
  BlockProducts block;
  block.block = name;
  block.crs = crs;
  return block;
}

// 100 m × 50 m near Adelaide.
StacItem item_of(const std::string& date) {
  StacItem item;
  item.file_name = "block_" + date + "_stac.json";
  item.scan.scan_id = item.scan.scan_date = date;
  item.scan.name = "veraison";
  item.scan.start_utc = date + "T01:02:03.004Z";
  item.scan.end_utc = date + "T01:30:00.000Z";
  item.assets = {{"plan_density",
                  "m2/m2",
                  "one-sided area",
                  "block_" + date + "_plan_density.tif",
                  {276100, 6099900},
                  0.25,
                  400,
                  200},
                 {"ground", "m", "", "block_" + date + "_ground.tif", {276100, 6099900}, 0.5, 200, 100}};
  return item;
}

json written_item(const BlockProducts& block, const StacItem& item) {
  const TemporaryFolder folder;
  const auto written = write_stac_item(block, item, kCollection, folder / "item.json");
  EXPECT_TRUE(written) << message(written);
  return written ? json::parse(read_file(folder / "item.json")) : json();
}

TEST(Stac, AnItemHasWhatTheSpecificationRequires) {
  const json item = written_item(block_named("block"), item_of("2019-02-11"));
  EXPECT_EQ(item["type"], "Feature");
  EXPECT_EQ(item["stac_version"], "1.0.0");
  EXPECT_EQ(item["id"], "block_2019-02-11");
  EXPECT_EQ(item["collection"], "block");
  EXPECT_EQ(item["properties"]["datetime"], "2019-02-11T01:02:03.004Z");
  EXPECT_EQ(item["properties"]["end_datetime"], "2019-02-11T01:30:00.000Z");
  EXPECT_EQ(item["properties"]["proj:epsg"], 7854);
  EXPECT_EQ(item["geometry"]["type"], "Polygon");
  ASSERT_EQ(item["assets"].size(), 2U);
  const json& density = item["assets"]["plan_density"];
  EXPECT_EQ(density["href"], "./block_2019-02-11_plan_density.tif");
  EXPECT_EQ(density["type"], "image/tiff; application=geotiff; profile=cloud-optimized");
  EXPECT_EQ(density["roles"], json({"data"}));
  EXPECT_EQ(density["proj:shape"], json({200, 400})) << "rows, columns";
  EXPECT_EQ(density["proj:transform"], json({0.25, 0.0, 276100.0, 0.0, -0.25, 6099950.0})) << "from the north-west";
  EXPECT_EQ(density["raster:bands"][0]["unit"], "m2/m2");
  EXPECT_EQ(density["raster:bands"][0]["nodata"], "nan");
  EXPECT_EQ(item["assets"]["ground"]["title"], "ground");
  std::set<std::string> relations;
  for (const json& link : item["links"]) {
    relations.insert(link["rel"]);
    EXPECT_EQ(link["href"], "./block_collection.json");
  }
  EXPECT_THAT(relations, ::testing::IsSupersetOf({"collection", "parent", "root"}));
}

TEST(Stac, TheOutlineIsAClosedRingInLongitudeAndLatitude) {
  const json item = written_item(block_named("block"), item_of("2019-02-11"));
  const json& ring = item["geometry"]["coordinates"][0];
  ASSERT_EQ(ring.size(), 5U);
  EXPECT_EQ(ring[0], ring[4]);
  // A degree of latitude is 110.95 km there, one of longitude 91.05 km (GRS 80 at 35.2° S); the grid is turned by 1.4°.
  const double width_m = 91050 * (ring[1][0].get<double>() - ring[0][0].get<double>());
  const double height_m = 110950 * (ring[3][1].get<double>() - ring[0][1].get<double>());
  EXPECT_NEAR(width_m, 100, 0.3);
  EXPECT_NEAR(height_m, 50, 0.3);
  double area = 0;
  for (int i = 0; i < 4; ++i)
    area += ring[i][0].get<double>() * ring[i + 1][1].get<double>() -
            ring[i + 1][0].get<double>() * ring[i][1].get<double>();
  EXPECT_GT(area, 0) << "counter-clockwise, as RFC 7946 wants it";
  EXPECT_GT(ring[0][0].get<double>(), 138);
  EXPECT_LT(ring[0][1].get<double>(), -35);
  for (int axis = 0; axis < 2; ++axis)
    for (const json& corner : ring) {
      EXPECT_LE(item["bbox"][axis].get<double>(), corner[axis].get<double>());
      EXPECT_GE(item["bbox"][axis + 2].get<double>(), corner[axis].get<double>());
    }
}

TEST(Stac, ACollectionSpansItsItemsAndLinksThem) {
  const TemporaryFolder folder;
  const std::vector<StacItem> items = {item_of("2019-02-11"), item_of("2018-11-22")};
  const auto written = write_stac_collection(block_named("block"), items, folder / kCollection);
  ASSERT_TRUE(written) << message(written);
  const json collection = json::parse(read_file(folder / kCollection));
  EXPECT_EQ(collection["type"], "Collection");
  EXPECT_EQ(collection["stac_version"], "1.0.0");
  EXPECT_EQ(collection["id"], "block");
  EXPECT_FALSE(collection["description"].get<std::string>().empty());
  EXPECT_FALSE(collection["license"].get<std::string>().empty());
  EXPECT_EQ(collection["extent"]["temporal"]["interval"],
            json::array({json::array({"2018-11-22T01:02:03.004Z", "2019-02-11T01:30:00.000Z"})}));
  EXPECT_EQ(collection["extent"]["spatial"]["bbox"][0], written_item(block_named("block"), items[0])["bbox"]);
  std::vector<std::string> linked;
  for (const json& link : collection["links"])
    if (link["rel"] == "item") linked.push_back(link["href"]);
  EXPECT_THAT(linked, ::testing::ElementsAre("./block_2019-02-11_stac.json", "./block_2018-11-22_stac.json"));
}

TEST(Stac, HostileNamesAreTextAndReferencesAreEncoded) {
  for (const std::string name : {"<img src=x onerror=alert(1)>", "Böll & \"Söhne\" 100 %? #1", "O'Brien's\\x\n"}) {
    StacItem item = item_of("2019-02-11");
    item.assets[0].file_name = name + ".tif";
    const json document = written_item(block_named(name), item);
    const std::string href = document["assets"]["plan_density"]["href"];
    EXPECT_TRUE(href.starts_with("./") && href.ends_with(".tif"));
    EXPECT_EQ(href.find_first_of(" <>\"#?&'\\\n", 2), std::string::npos) << href;
  }
  StacItem item = item_of("2019-02-11");
  item.assets[0].file_name = "Bö 1.tif";
  EXPECT_EQ(written_item(block_named("b"), item)["assets"]["plan_density"]["href"], "./B%C3%B6%201.tif");
}

TEST(Stac, ACrsWithoutACodeIsGivenAsProjjson) {
  const std::string crs = "+proj=tmerc +lat_0=0 +lon_0=138.5 +k=1 +x_0=500000 +y_0=10000000 +ellps=GRS80 +units=m";
  const json item = written_item(block_named("block", crs), item_of("2019-02-11"));
  EXPECT_TRUE(item["properties"]["proj:epsg"].is_null());
  EXPECT_EQ(item["properties"]["proj:projjson"]["type"], "ProjectedCRS");
}

TEST(Stac, AScanWithoutTimesHasThoseOfItsDay) {
  StacItem item = item_of("2019-02-11");
  item.scan.start_utc = item.scan.end_utc = "";
  const json properties = written_item(block_named("block"), item)["properties"];
  EXPECT_EQ(properties["datetime"], "2019-02-11T00:00:00Z");
  EXPECT_EQ(properties["end_datetime"], "2019-02-11T23:59:59Z");
}

TEST(Stac, WhatCannotBeDescribedIsRefused) {
  const TemporaryFolder folder;
  const auto code = [&](const BlockProducts& block, const StacItem& item) {
    const auto written = write_stac_item(block, item, kCollection, folder / "item.json");
    return written ? ErrorCode{} : written.error().code;
  };
  StacItem item = item_of("2019-02-11");
  EXPECT_EQ(code(block_named("b", "EPSG:99999"), item), ErrorCode::usage);
  item.scan.scan_date = "2019-02-31";
  EXPECT_EQ(code(block_named("b"), item), ErrorCode::usage);
  item = item_of("2019-02-11");
  item.assets.clear();
  EXPECT_EQ(code(block_named("b"), item), ErrorCode::usage);
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace rayfield::formats
