#include "cli/blocks/block_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayfield::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(BlockList, EveryBlockHasItsOwnFilesFromWhereTheListLies) {
  const auto blocks = parse_block_list(R"(
[[block]]
store = "north"
inputs = ["north/a.bag", "/data/b.bag"]
rig = "rig.toml"
date = 2019-02-11
name = "veraison"
output = "maps/north"
crs = "EPSG:7854"
set = ["posts.panel_length_m=7.5"]
[[block]]
store = "south"
inputs = ["south.ply"]
date = "2019-02-12"
)",
                                       "/farm/blocks.toml");
  ASSERT_TRUE(blocks) << blocks.error().line();
  ASSERT_EQ(blocks->size(), 2U);
  const BlockUpdate &north = (*blocks)[0], &south = (*blocks)[1];
  EXPECT_EQ(north.store, "/farm/north");
  EXPECT_THAT(north.inputs.files, ElementsAre("/farm/north/a.bag", "/data/b.bag"));
  EXPECT_EQ(north.inputs.rig_file, "/farm/rig.toml");
  EXPECT_EQ(north.date, "2019-02-11");
  EXPECT_EQ(north.name, "veraison");
  EXPECT_EQ(*north.output, "/farm/maps/north");
  EXPECT_EQ(north.crs, "EPSG:7854");
  EXPECT_THAT(north.settings, ElementsAre("posts.panel_length_m=7.5"));
  EXPECT_EQ(south.date, "2019-02-12");
  EXPECT_FALSE(south.output);
  EXPECT_THAT(south.crs, IsEmpty());
}

TEST(BlockList, WhatIsWrongIsNamedWithFileAndLine) {
  const std::string good = "[[block]]\nstore = \"a\"\ninputs = [\"a.ply\"]\ndate = 2019-02-11\n";
  const std::vector<std::array<std::string, 3>> cases = {
      {good + "inptus = 1\n", "blocks.toml:5", "unknown key 'inptus'"},
      {good + "rig = 3\n", "blocks.toml:5", "'rig' must be a text"},
      {"threads = 3\n" + good, "blocks.toml:1", "unknown key 'threads'"},
      {"[block]\nstore = \"a\"\n", "blocks.toml:1", "[[block]]"},
      {"[[block]]\nstore = \"a\"\ndate = 2019-02-11\n", "blocks.toml:1", "without 'inputs'"},
      {"[[block]]\ninputs = [\"a.ply\"]\ndate = 2019-02-11\n", "blocks.toml:1", "without 'store'"},
      {"[[block]]\nstore = \"a\"\ninputs = [\"a.ply\"]\n", "blocks.toml:1", "without 'date'"},
      {"[[block]]\nstore = \"a\"\ninputs = \"a.ply\"\n", "blocks.toml:3", "list of texts"},
      {"[[block]]\nstore = \"a\"\ninputs = []\n", "blocks.toml:3", "list of texts"},
      {"[[block]]\nstore = \"a\"\ninputs = [1]\n", "blocks.toml:3", "must be a text"},
      {"[[block]]\nstore = \"\"\n", "blocks.toml:2", "must be a text"},
      {"[[block]]\ndate = \"2019-02-30\"\n", "blocks.toml:2", "no such day"},
      {"[[block]]\ndate = 2019-02-30\n", "blocks.toml:2", ""},
      {"[[block]\n", "blocks.toml:1", ""},
      {"", "blocks.toml", "no block"},
      {"block = []\n", "blocks.toml", "block"}};
  for (const auto& [text, where, why] : cases) {
    const auto blocks = parse_block_list(text, "blocks.toml");
    ASSERT_FALSE(blocks) << text;
    EXPECT_EQ(blocks.error().code, ErrorCode::usage) << text;
    EXPECT_THAT(blocks.error().line(), HasSubstr(where)) << text;
    EXPECT_THAT(blocks.error().line(), HasSubstr(why)) << text;
  }
}

}  // namespace
}  // namespace rayfield::cli
