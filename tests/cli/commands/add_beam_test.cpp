#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/lane_cloud.h"
#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using testing::HasSubstr;

/// The lidar's beam on its way from a rig file into the store.
class AddBeam : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(rayfield({"init", store(), "--crs", "EPSG:32632"}).exit_code, 0);
    write_file(cloud(), lane_cloud(50));
  }
  Outcome add(const std::string& rig) {
    write_file(folder_.path("rig.toml"), rig);
    return rayfield(
        {"add", store(), cloud(), "--rig", folder_.path("rig.toml"), "--date", "2021-05-01", "--no-align", "-q"});
  }
  std::string store() const { return folder_.path("block"); }
  std::string cloud() const { return folder_.path("lane.ply"); }
  nlohmann::json beam_of_scan() const {
    return nlohmann::json::parse(rayfield({"status", store(), "--json"}).out)["scans"][0]["beam"];
  }
  Folder folder_;
};

TEST_F(AddBeam, IsKeptWithTheScan) {
  const Outcome added = add("[lidar]\nbeam_diameter_m = 0.0136\nbeam_divergence_rad = 0.0119\ndetection_share = 0.2\n");
  ASSERT_EQ(added.exit_code, 0) << added.err;
  const nlohmann::json beam = beam_of_scan();
  EXPECT_DOUBLE_EQ(beam["diameter_m"], 0.0136);
  EXPECT_DOUBLE_EQ(beam["divergence_rad"], 0.0119);
  EXPECT_DOUBLE_EQ(beam["detection_share"], 0.2);
  EXPECT_THAT(rayfield({"status", store()}).out, HasSubstr("13.6 mm + 11.9 mrad"));
}

TEST_F(AddBeam, OfAModelIsKnown) {
  ASSERT_EQ(add("[lidar]\nmodel = \"LMS511\"\n").exit_code, 0);
  EXPECT_DOUBLE_EQ(beam_of_scan()["divergence_rad"], 0.0119);
}

TEST_F(AddBeam, HasTheRangeResolutionOfTheRigOrElseThatOfTheCloud) {
  const std::string disc = "[lidar]\nbeam_diameter_m = 0.0136\nbeam_divergence_rad = 0.0119\n";
  std::string header_and_rays = lane_cloud(50);
  header_and_rays.insert(header_and_rays.find("element"),
                         "comment beam diameter_m 0.0136 divergence_rad 0.0119 range_resolution_m 0.2\n");
  write_file(cloud(), header_and_rays);
  ASSERT_EQ(add(disc).exit_code, 0);
  EXPECT_DOUBLE_EQ(beam_of_scan()["range_resolution_m"], 0.2);
  EXPECT_THAT(rayfield({"status", store()}).out, HasSubstr("resolves 0.2 m in range"));
  ASSERT_EQ(rayfield({"remove", store(), "2021-05-01"}).exit_code, 0);
  ASSERT_EQ(add(disc + "range_resolution_m = 0.4\n").exit_code, 0);
  EXPECT_DOUBLE_EQ(beam_of_scan()["range_resolution_m"], 0.4);
  ASSERT_EQ(rayfield({"remove", store(), "2021-05-01"}).exit_code, 0);
  ASSERT_EQ(add("[lidar]\nmodel = \"VLP-16\"\n").exit_code, 0);  // another beam than the header's
  EXPECT_FALSE(beam_of_scan().contains("range_resolution_m"));
}

TEST_F(AddBeam, HasTheReportedEchoOfTheRigOrElseThatOfTheCloud) {
  const std::string disc = "[lidar]\nbeam_diameter_m = 0.011\nbeam_divergence_rad = 0.0021\n";
  std::string header_and_rays = lane_cloud(50);
  header_and_rays.insert(header_and_rays.find("element"),
                         "comment beam diameter_m 0.011 divergence_rad 0.0021 returns last\n");
  write_file(cloud(), header_and_rays);
  ASSERT_EQ(add(disc).exit_code, 0);
  EXPECT_EQ(beam_of_scan()["returns"], "last");
  EXPECT_THAT(rayfield({"status", store()}).out, HasSubstr("reports the last echo"));
  ASSERT_EQ(rayfield({"remove", store(), "2021-05-01"}).exit_code, 0);
  ASSERT_EQ(add(disc + "returns = \"first\"\n").exit_code, 0);
  EXPECT_EQ(beam_of_scan()["returns"], "first");
  ASSERT_EQ(rayfield({"remove", store(), "2021-05-01"}).exit_code, 0);
  ASSERT_EQ(add("[lidar]\nmodel = \"OS1\"\n").exit_code, 0);  // another beam than the header's
  EXPECT_EQ(beam_of_scan()["returns"], "strongest");
}

TEST_F(AddBeam, ThatCannotBeIsRefusedAndNothingIsAdded) {
  const Outcome added = add("[lidar]\nbeam_divergence_rad = 1.5\n");
  EXPECT_EQ(added.exit_code, 2) << added.err;
  EXPECT_EQ(added.error_lines(), 1);
  EXPECT_THAT(added.err, HasSubstr("beam_divergence_rad"));
  EXPECT_TRUE(nlohmann::json::parse(rayfield({"status", store(), "--json"}).out)["scans"].empty());
}

}  // namespace
}  // namespace rayfield::test
