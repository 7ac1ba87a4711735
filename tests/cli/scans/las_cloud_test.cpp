#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "rayfield/core/map_frame.h"
#include "tests/cli/lane_cloud.h"
#include "tests/cli/program.h"
#include "tests/formats/las_support.h"

namespace rayfield::test {
namespace {

using formats::bytes::LasSpec;
using formats::bytes::LasTestPoint;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kStart_s = 1.6e9;  // 2020-09-13T12:26:40Z
constexpr double kAdjusted_s = kStart_s - 1315964800 + 18;

/// A LAS cloud of 200 points under a vehicle that drives east for 20 s, and its path.
class LasCloud : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(rayfield({"init", store(), "--crs", "EPSG:32632"}).exit_code, 0);
    write_file(cloud(), formats::bytes::las_bytes(spec()));
    write_file(path(), trajectory());
  }
  static LasSpec spec() {
    LasSpec spec;
    spec.offset = {500000, 5200000, 100};
    for (int i = 0; i < 200; ++i) {
      LasTestPoint point;
      point.position = spec.offset + Eigen::Vector3d(0.1 * i, 1, 0), point.time_s = kAdjusted_s + 0.1 * i;
      spec.points.push_back(point);
    }
    return spec;
  }
  static std::string trajectory(double start_s = kStart_s, const std::string& head = "") {
    std::string text = head;
    for (int i = 0; i <= 200; ++i)
      text += fmt::format("{:.3f} {:.3f} 5200000 102 0 0 0 1\n", start_s + 0.1 * i, 500000 + 0.1 * i);
    return text;
  }
  Outcome add(const std::vector<std::string>& more = {}, const std::string& file = {}) const {
    std::vector<std::string> words = {"add",    store(),      file.empty() ? cloud() : file,
                                      "--date", "2020-09-13", "--no-align"};
    words.insert(words.end(), more.begin(), more.end());
    return rayfield(words);
  }
  Outcome add_with_path(std::vector<std::string> more = {}) const {
    more.insert(more.end(), {"--trajectory", path()});
    return add(more);
  }
  // Refused with one line and a code, and nothing is added.
  void expect_refused(const Outcome& run, int code, const std::string& why) const {
    EXPECT_EQ(run.exit_code, code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(why));
    EXPECT_TRUE(nlohmann::json::parse(rayfield({"status", store(), "--json"}).out)["scans"].empty());
  }
  std::string store() const { return folder_.path("block"); }
  std::string cloud() const { return folder_.path("drive.las"); }
  std::string path() const { return folder_.path("drive.tum"); }
  Folder folder_;
};

TEST_F(LasCloud, IsAddedAlongItsTrajectoryWhichIsAnInputOfTheScan) {
  const Outcome added = add_with_path({"--json"});
  ASSERT_EQ(added.exit_code, 0) << added.err;
  const auto report = nlohmann::json::parse(added.out);
  EXPECT_EQ(report["rays"], 200);
  EXPECT_EQ(report["hits"], 200);
  EXPECT_THAT(report["notes"][0].get<std::string>(), HasSubstr("drive.las: the cloud has adjusted standard GPS time"));
  const auto snapshot = nlohmann::json::parse(read_file(store() + "/snapshots/00000001.json"))["snapshot"];
  const auto& scan = snapshot["scans"][0];
  ASSERT_EQ(scan["inputs"].size(), 2U);
  EXPECT_EQ(scan["inputs"][1]["name"], "drive.tum");
  EXPECT_NEAR(scan["start_time_s"].get<double>(), kStart_s, 1e-3);

  EXPECT_EQ(nlohmann::json::parse(add_with_path({"--json"}).out)["already_there"], true);
  write_file(path(), trajectory(kStart_s - 0.05));
  EXPECT_EQ(add_with_path().exit_code, 2) << "another trajectory is another scan";
}

TEST_F(LasCloud, SaysWhatItAssumedIfAskedTo) {
  EXPECT_THAT(add_with_path({"-v"}).out,
              AllOf(HasSubstr("18 leap seconds"), HasSubstr("rays begin on the trajectory")));
}

TEST_F(LasCloud, BeginsItsRaysAtTheLidarOfTheRig) {
  write_file(folder_.path("rig.toml"),
             "[lidar]\nmodel = \"VLP16\"\n[extrinsics]\nimu_from_lidar = { xyz = [0, 0, 0.5] }\n");
  const Outcome added = add_with_path({"-v", "--rig", folder_.path("rig.toml")});
  ASSERT_EQ(added.exit_code, 0) << added.err;
  EXPECT_THAT(added.out, HasSubstr("rays begin 0.000 0.000 0.500 m from the trajectory"));
  const auto snapshot = nlohmann::json::parse(read_file(store() + "/snapshots/00000001.json"))["snapshot"];
  EXPECT_NEAR(snapshot["scans"][0]["origin_bounds"]["min"][2].get<double>(), 102.5, 1e-3);
  EXPECT_DOUBLE_EQ(snapshot["scans"][0]["beam"]["diameter_m"].get<double>(), 0.011);
}

TEST_F(LasCloud, TakesATableWithoutOrientationsAndSaysThatTheRigIsInVain) {
  std::string table = "time,x,y,z\n";
  for (int i = 0; i <= 20; ++i) table += fmt::format("{},{},5200000,102\n", kStart_s + i, 500000 + i);
  write_file(path(), table);
  write_file(folder_.path("rig.toml"), "[extrinsics]\nimu_from_lidar = { xyz = [0, 0, 0.5] }\n");
  const Outcome added = add_with_path({"--rig", folder_.path("rig.toml")});
  ASSERT_EQ(added.exit_code, 0) << added.err;
  EXPECT_THAT(added.err,
              HasSubstr("the trajectory has no orientations: rays begin on it, not at the lidar, 0.50 m away"));
}

TEST_F(LasCloud, NeedsATrajectoryAndOtherCloudsTakeNone) {
  expect_refused(add(), 2, "drive.las: it says where points lie, not where the sensor stood; give --trajectory");
  write_file(folder_.path("lane.ply"), lane_cloud(50));
  expect_refused(add({"--trajectory", path()}, folder_.path("lane.ply")), 2, "only LAS clouds take one, and");
  expect_refused(add({"--trajectory", folder_.path("none.tum")}), 3, "none.tum");
  expect_refused(add({"--trajectory", path(), "--dry-run"}, folder_.path("lane.ply")), 2, "only LAS clouds take one");
}

TEST_F(LasCloud, OfAnotherDriveOrCrsIsRefused) {
  write_file(path(), trajectory(kStart_s + 86400));
  expect_refused(add_with_path(), 3, "none of its points was measured during the trajectory");
  expect_refused(add_with_path({"--dry-run"}), 3, "none of its points was measured during the trajectory");
  write_file(path(), trajectory(kStart_s, "# crs: EPSG:7854\n"));
  expect_refused(add_with_path(), 2, "drive.tum: it is in EPSG:7854, not in EPSG:32632");
  write_file(path(), trajectory());
  LasSpec other = spec();
  other.records = {formats::bytes::geokeys({{1024, 0, 1, 1}, {3072, 0, 1, 32633}})};
  write_file(cloud(), formats::bytes::las_bytes(other));
  expect_refused(add_with_path(), 3, "drive.las: it is in EPSG:32633, the store in EPSG:32632");
  other.encoding = 17;
  other.records = {formats::bytes::las_record("LASF_Projection", 2112, lookup_projected_crs("EPSG:32632")->wkt)};
  write_file(cloud(), formats::bytes::las_bytes(other));
  EXPECT_EQ(add_with_path().exit_code, 0);
}

TEST_F(LasCloud, ThatCannotBeReadIsRefusedInOneLine) {
  const std::string good = formats::bytes::las_bytes(spec());
  write_file(cloud(), formats::bytes::patched(good, 104, formats::bytes::u8(0x86)));
  expect_refused(add_with_path(), 3,
                 "drive.las, header at byte 104: its points are compressed (LAZ); uncompress it first");
  write_file(cloud(), good.substr(0, good.size() - 10));
  expect_refused(add_with_path(), 3, "the file is truncated: its header announces 200 points, 199 are complete");
  const Outcome truncated = add_with_path({"--allow-truncated"});
  EXPECT_EQ(truncated.exit_code, 0) << truncated.err;
  EXPECT_THAT(truncated.err, HasSubstr("199 are complete"));
}

TEST_F(LasCloud, TellsWhatItHoldsAndWhatItWouldTake) {
  const auto info = nlohmann::json::parse(rayfield({"info", cloud(), "--json"}).out);
  EXPECT_EQ(info["kind"], "LAS cloud");
  EXPECT_EQ(info["first_returns"], 200);
  EXPECT_EQ(info["start_utc"], "2020-09-13T12:26:40.000Z");
  EXPECT_THAT(rayfield({"info", cloud()}).out, AllOf(HasSubstr("LAS 1.4 cloud, 200 points of format 6"),
                                                     HasSubstr("CRS: none named"), HasSubstr("--trajectory")));
  const auto plan = nlohmann::json::parse(add_with_path({"--dry-run", "--json"}).out);
  EXPECT_EQ(plan["rays"], 200);
}

TEST_F(LasCloud, OfAListOfBlocksHasItsTrajectoryThere) {
  write_file(folder_.path("blocks.toml"),
             "[[block]]\nstore = \"new\"\ncrs = \"EPSG:32632\"\ninputs = [\"drive.las\"]\ntrajectory = \"drive.tum\"\n"
             "date = 2020-09-13\n");
  const Outcome run = rayfield({"update", "--batch", folder_.path("blocks.toml"), "--dry-run", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["blocks"][0]["rays"], 200);
}

}  // namespace
}  // namespace rayfield::test
