#include "cli/products/export_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace rayfield::cli {
namespace {

using test::Folder;
using test::read_file;
using test::write_file;
using ::testing::ElementsAre;

// Exports two products, the second with a style of its own beside it; says which were asked for anew.
std::vector<std::string> export_to(const Folder& folder, bool keep, std::uint64_t snapshot, const std::string& first,
                                   const std::string& second) {
  auto output = ExportFolder::open(folder.path(), "block", keep);
  EXPECT_TRUE(output) << output.error().line();
  std::vector<std::string> written;
  for (const auto& [name, source] : {std::pair{"a.csv", first}, std::pair{"b.tif", second}}) {
    if (!output->wants(name, source)) continue;
    write_file(output->path(name), name + source);
    if (std::string(name) == "b.tif") write_file(output->path("b.qml"), "style");
    written.emplace_back(name);
  }
  EXPECT_EQ(output->written_count(), written.size());
  EXPECT_EQ(output->products().size(), 2U);
  EXPECT_TRUE(output->publish(snapshot, first + second));
  return written;
}

bool holds(const Folder& folder, const std::string& content) {
  return ExportFolder::open(folder.path(), "block", true)->holds(content);
}

TEST(ExportFolder, KeepsWhatIsMadeOfTheSameAndWritesTheRest) {
  const Folder folder;
  EXPECT_THAT(export_to(folder, true, 1, "x", "y"), ElementsAre("a.csv", "b.tif"));
  EXPECT_TRUE(holds(folder, "xy"));
  EXPECT_THAT(export_to(folder, true, 2, "z", "y"), ElementsAre("a.csv"));
  EXPECT_EQ(read_file(folder.path("a.csv")), "a.csvz");
  EXPECT_EQ(read_file(folder.path("b.qml")), "style");
  EXPECT_TRUE(holds(folder, "zy"));
  EXPECT_FALSE(holds(folder, "xy"));
  EXPECT_THAT(export_to(folder, false, 3, "z", "y"), ElementsAre("a.csv", "b.tif")) << "a plain export writes all";
}

TEST(ExportFolder, AStyleWithASourceOfItsOwnChangesAloneAndIsNoProduct) {
  const Folder folder;
  const auto export_style = [&](const std::string& colours) {
    auto output = ExportFolder::open(folder.path(), "block", true);
    const bool raster = output->wants("b.tif", "y"), style = output->wants("b.qml", colours);
    if (raster) write_file(output->path("b.tif"), "raster");
    if (style) write_file(output->path("b.qml"), colours);
    EXPECT_THAT(output->products(), ElementsAre(folder.path("b.tif")));
    EXPECT_EQ(output->written_count(), raster ? 1U : 0U);
    EXPECT_TRUE(output->publish(1, "y" + colours));
    return std::pair(raster, style);
  };
  EXPECT_EQ(export_style("green"), std::pair(true, true));
  EXPECT_EQ(export_style("green"), std::pair(false, false));
  EXPECT_EQ(export_style("blue"), std::pair(false, true));
  EXPECT_EQ(read_file(folder.path("b.qml")), "blue");
  EXPECT_TRUE(holds(folder, "yblue"));
  EXPECT_FALSE(holds(folder, "ygreen"));
}

TEST(ExportFolder, WhatWasChangedOrRemovedSinceIsWrittenAgain) {
  const Folder folder;
  export_to(folder, true, 1, "x", "y");
  write_file(folder.path("a.csv"), "a.csvX");
  EXPECT_FALSE(holds(folder, "xy"));
  EXPECT_THAT(export_to(folder, true, 1, "x", "y"), ElementsAre("a.csv"));
  std::filesystem::remove(folder.path("b.tif"));
  EXPECT_FALSE(holds(folder, "xy"));
  EXPECT_THAT(export_to(folder, true, 1, "x", "y"), ElementsAre("b.tif"));
  EXPECT_TRUE(holds(folder, "xy"));
}

TEST(ExportFolder, AListThatIsDamagedOrNewerCountsAsNone) {
  const Folder folder;
  for (const char* list : {"{", "[]", "{\"format\": \"rayfield-products\", \"version\": 2}", ""}) {
    export_to(folder, true, 1, "x", "y");
    write_file(folder.path("block_products.json"), list);
    EXPECT_THAT(export_to(folder, true, 1, "x", "y"), ElementsAre("a.csv", "b.tif")) << list;
  }
}

TEST(ExportFolder, TheListNamesEveryProductWithItsDigestAndSnapshot) {
  const Folder folder;
  export_to(folder, true, 7, "x", "y");
  export_to(folder, true, 8, "z", "y");
  const auto list = nlohmann::json::parse(read_file(folder.path("block_products.json")));
  EXPECT_EQ(list["snapshot"], 8);
  ASSERT_EQ(list["files"].size(), 3U);
  EXPECT_EQ(list["files"][0]["name"], "a.csv");
  EXPECT_EQ(list["files"][0]["snapshot"], 8);
  EXPECT_EQ(list["files"][0]["size"], 6);
  EXPECT_EQ(list["files"][1]["name"], "b.qml");
  EXPECT_EQ(list["files"][2]["snapshot"], 7) << "kept, from the snapshot before";
}

}  // namespace
}  // namespace rayfield::cli
