#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kCrs = "EPSG:32632";

// Posts of rows 2.5 m apart, four in each.
std::string posts_csv(int rows, const std::string& header = "row,easting,northing") {
  std::string text = header + "\n";
  for (int row = 1; row <= rows; ++row)
    for (int post = 0; post < 4; ++post)
      text += std::to_string(row + 10) + "," + std::to_string(500000 + 2.5 * row) + "," +
              std::to_string(5200000 + 5 * post) + "\n";
  return text;
}

class Registry : public testing::Test {
 protected:
  std::string put(const std::string& name, const std::string& content) const {
    write_file(folder_.path(name), content);
    return folder_.path(name);
  }
  std::string store() const { return folder_.path("block"); }
  void init_with(const std::string& csv) const {
    const Outcome run = rayfield({"init", store(), "--crs", kCrs, "--reference", put("posts.csv", csv)});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  json list() const { return json::parse(rayfield({"registry", store(), "--json"}).out); }
  Folder folder_;
};

void expect_refused(const Outcome& run, int exit_code, const std::string& why) {
  EXPECT_EQ(run.exit_code, exit_code) << run.err;
  EXPECT_EQ(run.error_lines(), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr(why));
}

TEST_F(Registry, AReferenceRulesFromTheStart) {
  init_with(posts_csv(2));
  const json block = list();
  EXPECT_EQ(block["block"], "block") << "the folder's name";
  ASSERT_EQ(block["rows"].size(), 2U);
  EXPECT_EQ(block["rows"][0]["row_number"], 11);
  EXPECT_EQ(block["rows"][0]["source"], "surveyed");
  EXPECT_EQ(block["rows"][0]["valid_from"], nullptr);
  EXPECT_NEAR(block["rows"][0]["length_m"].get<double>(), 15, 1e-6);
  EXPECT_EQ(block["posts"].size(), 8U);
  EXPECT_EQ(block["posts"][0]["detected"], false);
}

TEST_F(Registry, ABadReferenceLeavesNoStoreBehind) {
  const auto init = [&](const std::string& file) {
    return rayfield({"init", store(), "--crs", kCrs, "--reference", file});
  };
  expect_refused(init(put("one.csv", "row,easting,northing\n1,500000,5200000\n")), 3, "it holds one post");
  expect_refused(init(put("far.csv", posts_csv(1) + "11,580000,5200000\n")), 3, "80 km apart");
  expect_refused(init(put("wrong.csv", "row,lon,lat\n1,138.5,-35\n1,138.5,-35.001\n")), 3, "EPSG:32632 is for");
  expect_refused(init(folder_.path("missing.gpkg")), 3, "there is no such file");
  expect_refused(init(put("a.shp", "x")), 2, "unknown kind of file");
  EXPECT_FALSE(std::filesystem::exists(store()));
}

TEST_F(Registry, RenamesAndRemembers) {
  init_with(posts_csv(2));
  const json before = list();
  const Outcome run = rayfield({"registry", "rename", store(), "--block", "Upper Hill", "--farm", "Château \"X\"",
                                "--variety", "Shiraz", "--row", "11=Row 12", "--row", "12=11", "--row", "11=12"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json after = list();
  EXPECT_EQ(after["block"], "Upper Hill");
  EXPECT_EQ(after["farm"], "Château \"X\"");
  EXPECT_EQ(after["variety"], "Shiraz");
  EXPECT_EQ(after["rows"][0]["row_number"], 12) << "numbers are exchanged";
  EXPECT_EQ(after["rows"][1]["row_number"], 11);
  EXPECT_EQ(after["rows"][0]["row_uid"], before["rows"][0]["row_uid"]);
  ASSERT_EQ(rayfield({"registry", store(), "rename", "--row", "12=Row 12"}).exit_code, 0);
  EXPECT_EQ(list()["rows"][0]["row_name"], "Row 12");
  EXPECT_EQ(list()["farm"], "Château \"X\"") << "what is not named stays";
}

TEST_F(Registry, RefusesNamesThatWouldConfuse) {
  init_with(posts_csv(2));
  const auto rename = [&](const std::string& option, const std::string& value) {
    return rayfield({"registry", "rename", store(), option, value});
  };
  expect_refused(rename("--row", "11=12"), 2, "another row has this number");
  expect_refused(rename("--row", "99=x"), 2, "the block has no such row");
  expect_refused(rename("--row", "11=0"), 2, "is no number of a row");
  expect_refused(rename("--row", "eleven"), 2, "it is not NUMBER=NAME");
  expect_refused(rename("--block", "../x"), 2, "it cannot be a name");
  expect_refused(rename("--block", ""), 2, "it cannot be a name");
  expect_refused(rename("--farm", std::string(81, 'x')), 2, "it cannot be a name");
  expect_refused(rayfield({"registry", "rename", store()}), 2, "no new name was given");
  expect_refused(rayfield({"registry", store(), "--farm", "x"}), 2, "names are given to `rename`");
  expect_refused(rayfield({"registry", "export", store()}), 2, "it takes the file to write");
  expect_refused(rayfield({"registry", "import", store()}), 2, "is missing");
  EXPECT_EQ(list()["rows"][0]["row_number"], 11);
}

TEST_F(Registry, WhatIsExportedComesBackWithNamesAndIdentities) {
  init_with(posts_csv(3));
  ASSERT_EQ(rayfield({"registry", "rename", store(), "--row", "12=Middle"}).exit_code, 0);
  const json before = list();
  for (const char* name : {"a.gpkg", "a.geojson", "a.csv"}) {
    ASSERT_EQ(rayfield({"registry", "export", store(), "-o", folder_.path(name)}).exit_code, 0) << name;
    expect_refused(rayfield({"registry", "export", store(), "-o", folder_.path(name)}), 2, "");
    const Outcome run = rayfield({"registry", "import", store(), folder_.path(name), "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json report = json::parse(run.out);
    EXPECT_EQ(report["rows_matched"], 3) << name;
    EXPECT_EQ(report["posts_matched"], 12) << name;
    EXPECT_EQ(report["geometry_changed"], false) << name;
    EXPECT_EQ(list(), before) << name;
  }
}

TEST_F(Registry, ASurveyThatIsRefinedKeepsIdentities) {
  init_with(posts_csv(2));
  const json before = list();
  std::string moved = "row,easting,northing\n";
  for (int row = 1; row <= 2; ++row)
    for (int post = 0; post < 4; ++post)
      moved += std::to_string(row + 20) + "," + std::to_string(500000.12 + 2.5 * row) + "," +
               std::to_string(5200000.08 + 5 * post) + "\n";
  const json report = json::parse(rayfield({"registry", "import", store(), put("moved.csv", moved), "--json"}).out);
  EXPECT_EQ(report["geometry_changed"], true);
  EXPECT_EQ(report["rows_matched"], 2);
  const json after = list();
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(after["rows"][i]["row_uid"], before["rows"][i]["row_uid"]);
    EXPECT_EQ(after["rows"][i]["row_number"], 21 + i) << "the survey's numbers are the farm's";
  }
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(after["posts"][i]["post_uid"], before["posts"][i]["post_uid"]);
    EXPECT_NEAR(after["posts"][i]["easting_m"].get<double>(), before["posts"][i]["easting_m"].get<double>() + 0.12,
                1e-6);
  }
}

TEST_F(Registry, ADryRunChangesNothing) {
  init_with(posts_csv(2));
  const json before = list();
  ASSERT_EQ(rayfield({"registry", "rename", store(), "--farm", "X", "--dry-run"}).exit_code, 0);
  ASSERT_EQ(rayfield({"registry", "import", store(), put("more.csv", posts_csv(3)), "--dry-run"}).exit_code, 0);
  EXPECT_EQ(list(), before);
}

}  // namespace
}  // namespace rayfield::test
