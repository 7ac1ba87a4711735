#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

// A block of two short rows, processed once, with names that formats like to trip over.
class Exchange : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    work_ = new Folder;
    const auto good = [](const Outcome& run) { ASSERT_EQ(run.exit_code, 0) << run.err; };
    good(rayfield({"simulate", small_site(*work_, kLateDate), "-o", work_->path("logs"), "-q"}));
    good(rayfield({"init", store(), "--crs", "EPSG:32632"}));
    good(rayfield({"add", store(), work_->path("logs/2021-07-01/rays.ply"), "--date", "2021-07-01", "-q"}));
    good(rayfield({"process", store(), "-q"}));
    good(rayfield(
        {"registry", "rename", store(), "--block", kBlock, "--farm", "<img onerror=alert(1)>", "--variety", "=1+1"}));
  }
  static void TearDownTestSuite() {
    delete work_;
    work_ = nullptr;
  }
  static std::string store() { return work_->path("block"); }
  // Zones of the small block, which is smaller than the smallest zone of a real one.
  static Outcome zones(const std::string& folder, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"zones", store(), "-o", folder, "--classes", "3", "--set", "min_zone_m2=4", "--set",
                               "smoothing_m=1.5", "--set", "cell_m=0.5", "--json", "-q"});
    return rayfield(more);
  }
  static std::set<std::string> names(const std::string& folder) {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder)) all.insert(entry.path().filename().string());
    return all;
  }
  static constexpr const char* kBlock = "Böll & \"Söhne\", Nord";
  static Folder* work_;
};
Folder* Exchange::work_ = nullptr;

TEST_F(Exchange, ExportWritesEveryFormatInWhateverCaseAndListsIt) {
  const Folder out;
  const std::string formats = "SHP,Kml,GeoJSON,flatgeobuf,CSV,GeoTIFF-plain";
  const Outcome run = rayfield(
      {"export", store(), "-o", out.path("maps"), "--format", formats, "--profile", "Deere,fieldview,geopard", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string block = kBlock, scan = block + "_2021-07-01_";
  const std::set<std::string> all = names(out.path("maps"));
  for (const std::string& name :
       {scan + "panels.shp.zip", scan + "panels.kml", scan + "panels.geojson", scan + "panels.fgb", scan + "deere.zip",
        scan + "fieldview.zip", scan + "geopard.zip", scan + "plan_density_plain.tif", block + "_panels.csv",
        block + "_row_metres.csv", block + "_fields.csv"})
    EXPECT_EQ(all.count(name), 1U) << name;
  const json list = json::parse(read_file(out.path("maps/block_products.json")));
  std::set<std::string> listed = {"block_products.json"};
  for (const json& file : list["files"]) listed.insert(file["name"].get<std::string>());
  EXPECT_EQ(listed, all) << "all that was written is in the list";
  EXPECT_THAT(read_file(out.path("maps/" + block + "_panels.csv")),
              HasSubstr("\"Böll & \"\"Söhne\"\", Nord\",<img onerror=alert(1)>,=1+1,8.4"));
  ASSERT_EQ(rayfield({"export", store(), "-o", out.path("again"), "--format", formats, "--profile",
                      "deere,fieldview,geopard", "-q"})
                .exit_code,
            0);
  EXPECT_EQ(content_of(out.path("again")), content_of(out.path("maps"))) << "equal bytes";
}

TEST_F(Exchange, AProfileAloneWritesNoMaps) {
  const Folder out;
  ASSERT_EQ(rayfield({"export", store(), "-o", out.path("maps"), "--profile", "plain", "-q"}).exit_code, 0);
  EXPECT_EQ(names(out.path("maps")),
            (std::set<std::string>{std::string(kBlock) + "_2021-07-01_plain.zip", std::string(kBlock) + "_fields.csv",
                                   "block_products.json"}));
}

TEST_F(Exchange, UnknownFormatsAndProfilesAreRefused) {
  const Folder out;
  for (const char* option : {"--format", "--profile"}) {
    const Outcome run = rayfield({"export", store(), "-o", out.path("maps"), option, "dwg"});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.error_lines(), 1);
  }
  EXPECT_FALSE(fs::exists(out.path("maps")));
}

// Leaf area of all panels, from the exported table.
double leaf_area_of_panels(const std::string& file) {
  std::istringstream text(read_file(file));
  std::string line;
  std::getline(text, line);
  double sum = 0;
  while (std::getline(text, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (int i = 0; i < 8; ++i) std::getline(cells, cell, ',');
    if (!cell.empty()) sum += std::stod(cell);
  }
  return sum;
}

TEST_F(Exchange, ZonesCoverTheBlockAndTheirMeansAgreeWithThePanels) {
  const Folder out;
  const Outcome run = zones(out.path("maps"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json report = json::parse(run.out);
  ASSERT_EQ(report["zones"].size(), 3U);
  double area = 0, leaf_area = 0, before = -1;
  for (const json& zone : report["zones"]) {
    area += zone["area_m2"].get<double>();
    leaf_area += zone["mean"].get<double>() * zone["measured"].get<double>();
    EXPECT_GT(zone["mean"].get<double>(), before) << "zones rise";
    EXPECT_LE(zone["min"].get<double>(), zone["mean"].get<double>());
    EXPECT_GE(zone["max"].get<double>(), zone["mean"].get<double>());
    before = zone["mean"].get<double>();
  }
  EXPECT_NEAR(area, report["area_m2"].get<double>(), 1e-6 * area);
  // The rows that were found, half of the site's spacing of 2.5 m to either side; a centimetre or two are the finder's.
  const json registry = json::parse(rayfield({"registry", store(), "--json"}).out);
  double ground = 0;
  for (const json& row : registry["rows"]) ground += 2.5 * row["length_m"].get<double>();
  EXPECT_NEAR(area, ground, 0.01 * ground);
  ASSERT_EQ(rayfield({"export", store(), "-o", out.path("maps"), "--format", "csv", "-q"}).exit_code, 0);
  const double of_panels = leaf_area_of_panels(out.path("maps/" + std::string(kBlock) + "_panels.csv"));
  EXPECT_NEAR(leaf_area, of_panels, 0.01 * of_panels);
}

TEST_F(Exchange, APrescriptionNeedsARateForEveryZone) {
  const Folder out;
  const std::string rates = out.path("rates.csv");
  write_file(rates, "zone,rate\n1,150\n2,225\n3,300\n");
  const std::vector<std::string> options = {"--rates", rates, "--rate-unit", "l/ha", "--product", "Copper"};
  const Outcome run = zones(out.path("maps"), options);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string stem = std::string(kBlock) + "_2021-07-01_";
  EXPECT_EQ(
      names(out.path("maps")),
      (std::set<std::string>{stem + "zones.gpkg", stem + "zones.geojson", stem + "zones.shp.zip", stem + "zones.png",
                             stem + "zones.svg", stem + "prescription.shp.zip", stem + "taskdata.zip"}));
  const auto before = content_of(out.path("maps"));
  ASSERT_EQ(zones(out.path("maps"), options).exit_code, 0);
  EXPECT_EQ(content_of(out.path("maps")), before) << "equal bytes";
  write_file(rates, "zone,rate\n1,150\n2,225\n7,300\n");
  const Outcome unknown = zones(out.path("maps"), options);
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_EQ(unknown.error_lines(), 1);
  EXPECT_THAT(unknown.err, HasSubstr("there is no zone 7"));
  EXPECT_EQ(zones(out.path("maps"), {"--rates", rates}).exit_code, 2) << "a unit and a product are missing";
  EXPECT_EQ(content_of(out.path("maps")), before);
}

TEST_F(Exchange, AFolderInTheWayLeavesTheOldProductsWhole) {
  const Folder out;
  const std::string maps = out.path("maps"), stem = std::string(kBlock) + "_2021-07-01_";
  const auto export_two = [&] {
    return rayfield({"export", store(), "-o", maps, "--format", "geojson,kml", "--overwrite", "-q"});
  };
  ASSERT_EQ(export_two().exit_code, 0);
  ASSERT_EQ(zones(maps).exit_code, 0);
  for (const char* name : {"panels.kml", "zones.shp.zip"}) {
    fs::remove(maps + "/" + stem + name);
    fs::create_directory(maps + "/" + stem + name);
    write_file(maps + "/" + stem + name + "/kept", "x");
  }
  const auto before = content_of(maps);
  for (const Outcome& run : {export_two(), zones(maps)}) {
    EXPECT_EQ(run.exit_code, 5) << run.err;
    EXPECT_EQ(run.error_lines(), 1);
    EXPECT_THAT(run.err, HasSubstr("a folder is in the way"));
  }
  EXPECT_EQ(content_of(maps), before);
}

TEST_F(Exchange, PointCloudsAreTheSameAtAnyNumberOfThreadsAndAppearWholeOrNotAtAll) {
  const Folder out;
  const std::string maps = out.path("maps"), stem = std::string(kBlock) + "_2021-07-01_cloud";
  const std::vector<std::string> clouds = {"export",     store(),    "-o",      maps, "--date",
                                           "2021-07-01", "--format", "ply,las", "-q"};
  ASSERT_EQ(rayfield(clouds).exit_code, 0);
  const auto before = content_of(maps);
  ASSERT_EQ(before.count(stem + ".ply"), 1U);
  ASSERT_EQ(before.count(stem + ".las"), 1U);
  // Both hold the same points: 42 bytes each after the header, and 40.
  const std::string ply = read_file(maps + "/" + stem + ".ply"), las = read_file(maps + "/" + stem + ".las");
  const std::size_t head = ply.find("end_header\n") + 11;
  std::uint32_t points_at = 0;
  std::memcpy(&points_at, las.data() + 96, sizeof(points_at));
  ASSERT_GT(las.size(), points_at + 10000 * 40);
  EXPECT_EQ((ply.size() - head) / 42, (las.size() - points_at) / 40);
  for (const char* threads : {"1", "3"}) {
    std::vector<std::string> again = clouds;
    again.insert(again.end(), {"--threads", threads, "--memory", "256M"});
    ASSERT_EQ(rayfield(again).exit_code, 0);
    EXPECT_EQ(content_of(maps), before) << threads << " threads";
  }
  for (const std::uint64_t bytes : {300, 100000}) {
    const Outcome full = rayfield_with_file_limit(clouds, bytes);
    EXPECT_EQ(full.exit_code, 5) << bytes << ": " << full.err;
    EXPECT_EQ(full.error_lines(), 1);
  }
  EXPECT_EQ(content_of(maps), before);
}

TEST_F(Exchange, ADiskWithoutSpaceLeavesTheOldProductsWhole) {
  const Folder out;
  const std::string maps = out.path("maps");
  const std::vector<std::string> all = {"export", store(), "-o", maps, "--format", "shp,kml,geojson,flatgeobuf,csv",
                                        "-q"};
  ASSERT_EQ(rayfield(all).exit_code, 0);
  ASSERT_EQ(zones(maps).exit_code, 0);
  const auto before = content_of(maps);
  for (const std::uint64_t bytes : {500, 1000, 3000}) {
    const Outcome run = rayfield_with_file_limit(all, bytes);
    EXPECT_EQ(run.exit_code, 5) << bytes << ": " << run.err;
    EXPECT_EQ(run.error_lines(), 1);
    const Outcome of_zones = rayfield_with_file_limit({"zones", store(), "-o", maps, "-q"}, bytes);
    EXPECT_EQ(of_zones.exit_code, 5) << bytes << ": " << of_zones.err;
  }
  EXPECT_EQ(content_of(maps), before);
}

}  // namespace
}  // namespace rayfield::test
