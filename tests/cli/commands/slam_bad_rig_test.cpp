#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/drive_logs.h"

namespace rayfield::test {
namespace {

using testing::HasSubstr;

// `text` with the line that begins with `key` replaced.
std::string with_line(std::string text, const std::string& key, const std::string& line) {
  const std::size_t start = text.find("\n" + key) + 1;
  EXPECT_NE(start, 0U) << key;
  return text.replace(start, text.find('\n', start) - start, line);
}

// Everything that can be wrong with a rig file, the options and the places to write to. The drive is simulated once.
class BadRig : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    drive_ = new Folder;
    log_ = simulate_drive(*drive_);
    good_ = read_file(log_.rig);
  }
  static void TearDownTestSuite() {
    delete drive_;
    drive_ = nullptr;
  }
  std::string cloud() const { return work_.path("cloud.ply"); }
  std::string put(const std::string& name, const std::string& content) const {
    write_file(work_.path(name), content);
    return work_.path(name);
  }
  Outcome slam(const std::string& rig, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"slam", log_.bag, "--rig", rig, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    if (std::find(more.begin(), more.end(), "-o") == more.end()) arguments.insert(arguments.end(), {"-o", cloud()});
    return rayfield(arguments);
  }
  void expect_refused(const Outcome& run, int exit_code, const std::string& why) const {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(why));
    ASSERT_TRUE(nlohmann::json::accept(run.out)) << run.out;
    EXPECT_EQ(nlohmann::json::parse(run.out)["error"]["code"], exit_code);
    EXPECT_FALSE(std::filesystem::exists(cloud()));
  }
  void expect_rig_refused(const std::string& text, const std::string& why) const {
    const Outcome run = slam(put("bad.toml", text));
    expect_refused(run, 2, why);
    EXPECT_THAT(run.err, HasSubstr("bad.toml"));
  }

  static Folder* drive_;
  static SimulatedLog log_;
  static std::string good_;
  Folder work_;
};
Folder* BadRig::drive_ = nullptr;
SimulatedLog BadRig::log_;
std::string BadRig::good_;

TEST_F(BadRig, MistakesAreNamedWithTheirLineOrKey) {
  expect_rig_refused(with_line(good_, "no_return", "colour = \"red\""), "lidar.colour: unknown key");
  expect_rig_refused(good_ + "\n[radar]\ntopic = \"/radar\"\n", "radar: unknown key");
  expect_rig_refused(
      with_line(good_, "spinner_from_lidar", "spinner_from_lidar = { xyz = [0, 0, 0], q = [0.6, 0, 0, 0.6] }"),
      "must be a unit quaternion");
  expect_rig_refused(
      with_line(good_, "spinner_from_lidar", "spinner_from_lidar = { xyz = [0, 0, 0], q = [0, 0, 0, 0] }"),
      "must be a unit quaternion");
  expect_rig_refused(with_line(good_, "axis", "axis = [0, 0, 3]"), "must be a unit vector");
  expect_rig_refused(with_line(good_, "max_range_m", "max_range_m = 0.05"), "lidar.max_range_m");
  expect_rig_refused(with_line(good_, "max_range_m", "max_range_m = nan"), "lidar.max_range_m");
  expect_rig_refused(with_line(good_, "imu_from_gps", ""), "imu_from_gps is missing");
  expect_rig_refused("[lidar\n", "line 1");
  expect_rig_refused("", "is missing");
}

TEST_F(BadRig, BinaryGarbageAndWhatIsNoFileAreRefused) {
  expect_rig_refused(std::string("[lidar]\ntopic = \"a\0b\"\n", 23), "line 2: a control character");
  expect_rig_refused("[lidar]\ntopic = \"a\x1b[31m\"\n", "line 2: a control character");
  expect_rig_refused("[lidar]\ntopic = \"\xff\xfe\"\n", "line 2");
  expect_rig_refused("x = " + std::string(5000, '[') + "\n", "line 1");
  expect_rig_refused(read_file(log_.bag).substr(0, 5000), "line");
  expect_refused(slam(log_.bag), 3, "larger than 1 MiB");
  expect_refused(slam(work_.path("missing.toml")), 3, "No such file");
  expect_refused(slam(work_.path()), 3, "not a regular file");
}

TEST_F(BadRig, WhatDoesNotFitTheLogIsRefusedWithWhatWould) {
  const auto topic = [&](const std::string& right, const std::string& wrong) {
    std::string text = good_;
    return text.replace(text.find(right), right.size(), wrong);
  };
  expect_refused(slam(put("a.toml", topic("/lidar/scan", "/velodyne"))), 3, "choose from: /lidar/scan");
  expect_refused(slam(put("a.toml", topic("/imu/data", "/imu"))), 3, "choose from: /imu/data");
  expect_refused(slam(put("a.toml", topic("/gps/fix", "/fix"))), 3, "choose from: /gps/fix");
  expect_refused(slam(put("a.toml", topic("\"spinner\"", "\"wheel\""))), 2, "joints there: spinner");
  expect_refused(slam(put("a.toml", with_line(good_, "max_range_m", "max_range_m = 400"))), 2, "set max_range_m = 40");
}

TEST_F(BadRig, AMountingThatIsFarFromTheTruthGivesNoMap) {
  const std::string pose = "spinner_from_lidar = { xyz = [0.035, 0, 0.02], q = [0, 0.7071068, 0, 0.7071068] }";
  expect_refused(slam(put("a.toml", with_line(good_, "spinner_from_lidar", pose))), 3, "trajectory");
  expect_refused(slam(put("a.toml", with_line(good_, "axis", "axis = [1, 0, 0]"))), 3, "trajectory");
}

TEST_F(BadRig, TheProposedRigWorksOnceTheMountingIsFilledIn) {
  const auto info = nlohmann::json::parse(rayfield({"info", log_.bag, "--json", "-q"}).out);
  const std::string proposed = info["proposed_rig"];
  expect_rig_refused(proposed, "is missing");
  std::string filled = proposed.substr(0, proposed.find("[extrinsics]"));
  filled += good_.substr(good_.find("[extrinsics]"));
  const Outcome run = slam(put("filled.toml", filled), {"--crs", "EPSG:32632"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["report"]["georeferenced"], true);
  EXPECT_EQ(info["gps"][0]["utm"], "EPSG:32632") << "longitude 8.4 lies in UTM zone 32";
}

TEST_F(BadRig, OptionsThatMakeNoSenseAreRefused) {
  for (const char* threads : {"0", "-1", "two", "1.5", "99999", ""})
    expect_refused(slam(log_.rig, {"--threads", threads}), 2, "--threads");
  expect_refused(slam(log_.rig, {"--crs", "EPSG:4326"}), 2, "geographic");
  expect_refused(slam(log_.rig, {"--crs", "nonsense"}), 2, "PROJ does not know it");
  expect_refused(slam(log_.rig, {"--crs", "EPSG:2225"}), 2, "not in metres");
  expect_refused(slam(log_.rig, {"--crs", "EPSG:32632\n"}), 2, "not a code");
  // Web Mercator stretches by 1/cos(47.3°) = 1.47, and zone 1 lies on the other side of the Earth.
  expect_refused(slam(log_.rig, {"--crs", "EPSG:3857"}), 2, "a metre is 1.47");
  expect_refused(slam(log_.rig, {"--crs", "EPSG:32601"}), 2, "e.g. EPSG:32632");
  expect_refused(rayfield({"slam", log_.bag, "-o", cloud(), "--json"}), 2, "--rig is required");
  expect_refused(rayfield({"add", work_.path("block"), "--json"}), 2, "CLOUD");
}

TEST_F(BadRig, PlacesThatCannotBeWrittenToAreRefusedBeforeTheWork) {
  const auto refuse = [&](const std::vector<std::string>& more, int exit_code, const std::string& why) {
    const Outcome run = slam(log_.rig, more);
    expect_refused(run, exit_code, why);
    EXPECT_THAT(run.err, testing::Not(HasSubstr("reading log"))) << "refused only after the work had begun";
  };
  refuse({"-o", work_.path("no/such/cloud.ply")}, 2, "there is no folder");
  refuse({"-o", work_.path()}, 2, "it is a folder");
  refuse({"-o", ""}, 2, "it is empty");
  refuse({"-o", work_.path("folder") + "/"}, 2, "does not name a file");
  refuse({"-o", "/proc/cloud.ply"}, 5, "/proc");
  for (const char* option : {"--trajectory", "--report", "--picture"})
    refuse({option, work_.path("no/such/file")}, 2, "there is no folder");
  refuse({"--trajectory", cloud()}, 2, "names the same file");
  refuse({"--trajectory", log_.rig, "--overwrite"}, 2, "it is an input");
  refuse({"-o", log_.bag, "--overwrite"}, 2, "it is an input");
}

TEST_F(BadRig, WhatIsThereIsKeptWithoutOverwrite) {
  for (const char* option : {"-o", "--trajectory", "--report", "--picture"}) {
    const std::string there = put("there", "mine");
    expect_refused(slam(log_.rig, {option, there}), 2, "it is there already");
    EXPECT_EQ(read_file(there), "mine");
  }
}

TEST_F(BadRig, AFullDiskEndsWithFiveAndLeavesNoCloud) {
  const Outcome run = rayfield_with_file_limit({"slam", log_.bag, "--rig", log_.rig, "-o", cloud(), "--json"}, 4 << 20);
  expect_refused(run, 5, "cannot write ray cloud");
  EXPECT_TRUE(std::filesystem::is_empty(work_.path())) << "a part of the cloud is left";
}

TEST_F(BadRig, ADryRunLooksAtEverythingAndWritesNothing) {
  const Outcome good = slam(log_.rig, {"--dry-run"});
  ASSERT_EQ(good.exit_code, 0) << good.err;
  EXPECT_GT(nlohmann::json::parse(good.out)["disk_bytes"], 1000000);
  EXPECT_TRUE(std::filesystem::is_empty(work_.path()));
  expect_refused(rayfield({"slam", work_.path("missing.bag"), "--rig", log_.rig, "-o", cloud(), "--dry-run", "--json"}),
                 3, "No such file");
}

TEST_F(BadRig, ControlCharactersInConfigurationAndSiteFilesAreRefused) {
  const std::string text("[slam]\nthreads = \"\x01\"\n");
  expect_refused(slam(log_.rig, {"--config", put("c.toml", text)}), 2, "c.toml, line 2: a control character");
  expect_refused(slam(log_.rig, {"--config", work_.path()}), 3, "not a regular file");
  const Outcome site = rayfield(
      {"simulate", put("s.toml", std::string("[site]\nname = \"\0\"\n", 18)), "-o", work_.path("d"), "--json"});
  expect_refused(site, 2, "s.toml, line 2: a control character");
}

}  // namespace
}  // namespace rayfield::test
