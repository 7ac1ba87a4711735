#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using nlohmann::json;

// One canopy, driven in four ways: every second lane, from the other side, with a lane left out, and in part.
const std::string kDrives =
    "[[date]]\ndate = \"2021-07-01\"\nleaf_fraction = 0.6\nseed = 1\n"
    "[[date]]\ndate = \"2021-07-02\"\nleaf_fraction = 0.6\nseed = 2\norder = \"reverse\"\n"
    "[[date]]\ndate = \"2021-07-03\"\nleaf_fraction = 0.6\nseed = 3\nlanes = [2, 0]\n"
    "[[date]]\ndate = \"2021-07-04\"\nleaf_fraction = 0.6\nseed = 4\nlanes = [1, 0]\n";

class RegistryChain : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    logs_ = new Folder;
    const Outcome run = rayfield({"simulate", small_site(*logs_, kDrives), "-o", logs_->path("logs"), "-q"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  static void TearDownTestSuite() {
    delete logs_;
    logs_ = nullptr;
  }
  static void add(const std::string& store, const std::string& date) {
    const Outcome run = rayfield({"add", store, logs_->path("logs/" + date + "/rays.ply"), "--date", date, "-q"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  static json process(const std::string& store) {
    const Outcome run = rayfield({"process", store, "--json", "-q"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json::parse(run.out, nullptr, false);
  }
  static json registry(const std::string& store) {
    return json::parse(rayfield({"registry", store, "--json"}).out, nullptr, false);
  }
  static Folder* logs_;
};
Folder* RegistryChain::logs_ = nullptr;

// Leaf area of each panel, by date, from the exported table.
std::map<std::string, std::map<std::string, double>> leaf_areas(const std::string& store, const std::string& maps) {
  EXPECT_EQ(rayfield({"export", store, "-o", maps, "--format", "csv", "-q"}).exit_code, 0);
  std::map<std::string, std::map<std::string, double>> areas;
  for (const auto& file : std::filesystem::directory_iterator(maps)) {
    if (file.path().string().find("_panels.csv") == std::string::npos) continue;
    std::istringstream text(read_file(file.path()));
    std::string line;
    std::getline(text, line);
    while (std::getline(text, line)) {
      std::vector<std::string> fields;
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) fields.push_back(cell);
      if (fields.size() > 7 && !fields[7].empty()) areas[fields[5]][fields[0]] = std::stod(fields[7]);
    }
  }
  return areas;
}

TEST_F(RegistryChain, PanelsKeepTheirIdentityAndBordersHoweverTheBlockIsDriven) {
  const Folder work;
  const std::string store = work.path("block");
  ASSERT_EQ(rayfield({"init", store, "--crs", "EPSG:32632"}).exit_code, 0);
  add(store, "2021-07-01");
  process(store);
  const json first = registry(store);
  ASSERT_EQ(first["rows"].size(), 2U);
  for (const char* date : {"2021-07-02", "2021-07-03", "2021-07-04"}) {
    add(store, date);
    const json report = process(store);
    for (const json& scan : report["scans"]) {
      if (scan["scan_id"] == date) continue;
      EXPECT_EQ(scan["files_made"], 0) << scan["scan_id"] << " was made anew for " << date;
    }
    const json now = registry(store);
    EXPECT_EQ(now["rows"], first["rows"]) << date;
    EXPECT_EQ(now["panels"], first["panels"]) << date;
    for (const json& post : now["posts"]) EXPECT_EQ(post["valid_to"], nullptr) << date << " " << post;
    EXPECT_EQ(now["posts"].size(), first["posts"].size()) << date;
  }
  // One date made anew forgets nothing of what the others have shown.
  const auto before = content_of(store + "/registry");
  const Outcome again = rayfield({"process", store, "--overwrite", "--date", "2021-07-03", "--json", "-q"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_GT(json::parse(again.out)["scans"][0]["files_made"], 5);
  EXPECT_EQ(content_of(store + "/registry"), before);
  const auto areas = leaf_areas(store, work.path("maps"));
  ASSERT_EQ(areas.size(), 4U);
  ASSERT_EQ(areas.at("2021-07-01").size(), first["panels"].size());
  for (const auto& [panel, area] : areas.at("2021-07-01"))
    EXPECT_NEAR(areas.at("2021-07-02").at(panel), area, 0.06 * area) << "the other way round";
}

TEST_F(RegistryChain, ASurveyRulesAndBringsTheFarmsNumbers) {
  const Folder work;
  const std::string found = work.path("found"), surveyed = work.path("surveyed");
  ASSERT_EQ(rayfield({"init", found, "--crs", "EPSG:32632"}).exit_code, 0);
  add(found, "2021-07-01");
  process(found);
  ASSERT_EQ(rayfield({"registry", "rename", found, "--row", "1=41", "--row", "2=42"}).exit_code, 0);
  ASSERT_EQ(rayfield({"registry", "export", found, "-o", work.path("rows.gpkg")}).exit_code, 0);

  ASSERT_EQ(rayfield({"init", surveyed, "--crs", "EPSG:32632", "--reference", work.path("rows.gpkg")}).exit_code, 0);
  add(surveyed, "2021-07-02");
  const json report = process(surveyed);
  EXPECT_EQ(report["rows"], 2);
  const json was = registry(found), now = registry(surveyed);
  ASSERT_EQ(now["panels"].size(), was["panels"].size());
  for (std::size_t i = 0; i < now["panels"].size(); ++i) {
    EXPECT_NEAR(now["panels"][i]["chainage_start_m"].get<double>(), was["panels"][i]["chainage_start_m"].get<double>(),
                0.02);
    EXPECT_EQ(now["panels"][i]["row_number"], was["panels"][i]["row_number"]);
  }
  std::size_t detected = 0;
  for (const json& post : now["posts"]) detected += post["detected"] == true ? 1 : 0;
  EXPECT_GE(detected + 1, now["posts"].size()) << "the scan shows the surveyed posts";
  EXPECT_EQ(now["rows"][0]["row_number"], 41);
  const auto areas = leaf_areas(surveyed, work.path("maps"));
  EXPECT_EQ(areas.at("2021-07-02").size(), now["panels"].size());

  // Renaming makes nothing anew; a survey of another place is refused before anything is computed.
  ASSERT_EQ(rayfield({"registry", "rename", surveyed, "--block", "Hill", "--row", "41=1"}).exit_code, 0);
  EXPECT_EQ(process(surveyed)["scans"][0]["files_made"], 0);
  EXPECT_EQ(registry(surveyed)["block"], "Hill");
  write_file(work.path("far.csv"), "row,lon,lat\n1,8.9,47.6\n1,8.9,47.601\n");
  const Outcome far = rayfield({"registry", "import", surveyed, work.path("far.csv")});
  EXPECT_EQ(far.exit_code, 3);
  EXPECT_THAT(far.err, testing::HasSubstr("away from the store's scans"));
}

}  // namespace
}  // namespace rayfield::test
