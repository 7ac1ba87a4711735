#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/cli/drive_logs.h"

namespace rayfield::test {
namespace {

using testing::HasSubstr;

constexpr double kGravity_m_s2 = 9.80665;

// Everything that can be wrong with the log of a drive, through the command line. The drive is simulated once.
class BadLog : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    drive_ = new Folder;
    log_ = simulate_drive(*drive_);
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
  std::string damaged(const Damage& damage) const { return write_damaged(log_, work_.path("damaged.bag"), damage); }
  Outcome slam(const std::string& bag, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"slam", bag, "--rig", log_.rig, "--crs", "EPSG:32632", "-o", cloud(), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return rayfield(arguments);
  }
  static nlohmann::json info(const std::string& bag) {
    const Outcome run = rayfield({"info", bag, "--json", "-q"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out);
  }
  // A refusal: exit code, one line that names file and reason and says what next, one JSON document of the same, and
  // no file that could be taken for a result.
  void expect_refused(const Outcome& run, int exit_code, const std::string& file, const std::string& why) const {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    ASSERT_TRUE(nlohmann::json::accept(run.out)) << run.out;
    const auto error = nlohmann::json::parse(run.out)["error"];
    EXPECT_EQ(error["code"], exit_code);
    EXPECT_THAT(error["where"].get<std::string>(), HasSubstr(file));
    EXPECT_THAT(run.err, HasSubstr(why));
    EXPECT_FALSE(error["next"].get<std::string>().empty()) << run.err;
    EXPECT_EQ(clouds_left(), 0) << "a refused log leaves a cloud, or a part of one";
  }
  int clouds_left() const {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(work_.path()))
      count += entry.path().filename().string().rfind("cloud.ply", 0) == 0;
    return count;
  }

  static Folder* drive_;
  static SimulatedLog log_;
  Folder work_;
};
Folder* BadLog::drive_ = nullptr;
SimulatedLog BadLog::log_;

TEST_F(BadLog, ATrajectoryOfAnotherDayGivesNoCloud) {
  std::string poses;
  for (int i = 0; i < 99; ++i) poses += std::to_string(i) + " 454629 5238676 83 0 0 0 1\n";
  expect_refused(slam(log_.bag, {"--use-trajectory", put("other_day.tum", poses)}), 3, log_.bag, "none of its rays");
}

TEST_F(BadLog, WhatIsNoBagIsRefusedByEveryCommand) {
  const std::string store = work_.path("block");
  ASSERT_EQ(rayfield({"init", store, "--crs", "EPSG:32632"}).exit_code, 0);
  const auto refuse = [&](const std::string& bag, const std::string& why) {
    expect_refused(slam(bag), 3, bag, why);
    expect_refused(rayfield({"info", bag, "--json"}), 3, bag, why);
    expect_refused(rayfield({"add", store, bag, "--rig", log_.rig, "--date", "2021-07-01", "--json"}), 3, bag, why);
  };
  refuse(put("empty.bag", ""), "the file is empty");
  refuse(put("text.bag", "no bag at all\n"), "not a ROS bag");
  refuse(put("old.bag", "#ROSBAG V1.2\n"), "not version 2.0");
  refuse(put("ros2.mcap", "\x89MCAP0\r\n"), "ROS 2");
  refuse(put("start.bag", "#ROS"), "ends within its first line");
  refuse(work_.path("missing.bag"), "No such file");
  std::filesystem::create_directory(work_.path("folder.bag"));
  expect_refused(slam(work_.path("folder.bag")), 3, "folder.bag", "not a regular file");
  EXPECT_EQ(nlohmann::json::parse(rayfield({"status", store, "--json"}).out)["scans"].size(), 0U);
}

TEST_F(BadLog, ABagWithoutMessagesIsRefused) {
  const std::string header = read_file(log_.bag).substr(0, 4117);
  expect_refused(slam(put("header.bag", header)), 3, "header.bag", "no messages");
  EXPECT_THAT(info(work_.path("header.bag"))["problems"].dump(), HasSubstr("no messages"));
}

TEST_F(BadLog, NamesTheSensorThatIsMissing) {
  const auto never = [](auto&, double) { return false; };
  expect_refused(slam(damaged({.lidar = never})), 3, "damaged.bag", "no lidar topic /lidar/scan");
  EXPECT_THAT(info(work_.path("damaged.bag"))["problems"].dump(), HasSubstr("no lidar"));
  expect_refused(slam(damaged({.imu = never})), 3, "damaged.bag", "no IMU topic /imu/data");
  EXPECT_THAT(info(work_.path("damaged.bag"))["problems"].dump(), HasSubstr("no IMU"));
  expect_refused(slam(damaged({.spinner = never})), 3, "damaged.bag", "no spinner topic /spinner/joint_states");
}

TEST_F(BadLog, RawPacketsAreNamedWithWhatToDo) {
  const std::string bag = write_raw_packets(work_.path("raw.bag"));
  const Outcome run = slam(bag);
  expect_refused(run, 3, bag, "raw packets: /os/lidar_packets (ouster_ros/PacketMsg)");
  EXPECT_THAT(run.err, HasSubstr("through the sensor's ROS driver"));
  EXPECT_THAT(info(bag)["problems"].dump(), HasSubstr("through the sensor's ROS driver"));
}

TEST_F(BadLog, WithoutGpsTheCloudIsLocalAndNoStoreTakesIt) {
  const std::string bag = damaged({.gps = [](GpsFix&, double) { return false; }});
  EXPECT_THAT(info(bag)["problems"].dump(), HasSubstr("nothing can be georeferenced"));
  const Outcome run = slam(bag);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("warning: nothing is georeferenced: the log has no usable GPS fix on /gps/fix"));
  const auto result = nlohmann::json::parse(run.out);
  EXPECT_EQ(result["georeferenced"], false);
  EXPECT_EQ(result["crs"], "");
  EXPECT_THAT(read_file(cloud()).substr(0, 200), HasSubstr("comment crs local"));

  const std::string store = work_.path("block");
  ASSERT_EQ(rayfield({"init", store, "--crs", "EPSG:32632"}).exit_code, 0);
  for (const std::string& input : {bag, cloud()}) {
    const Outcome add = rayfield({"add", store, input, "--rig", log_.rig, "--date", "2021-07-01"});
    EXPECT_EQ(add.exit_code, 3) << add.err;
    EXPECT_THAT(add.err, HasSubstr(input == bag ? "no usable GPS fix" : "local frame"));
  }
  EXPECT_EQ(nlohmann::json::parse(rayfield({"status", store, "--json"}).out)["scans"].size(), 0U);
}

// As of a vehicle that is parked: the fixes are there, and too near to each other to tell how the drive lies.
TEST_F(BadLog, FixesThatCannotPlaceTheDriveInTheMapThatWasAskedForAreRefused) {
  const std::string bag = damaged({.gps = [](GpsFix&, double elapsed_s) { return elapsed_s < 4; }});
  expect_refused(slam(bag), 3, "damaged.bag", "nothing is georeferenced: ");
}

TEST_F(BadLog, AfterAClockJumpOfAnHourTheLongerPartIsUsedAndSaid) {
  const std::string bag =
      damaged(other_stamps([](double time_s, double elapsed_s) { return elapsed_s > 20 ? time_s + 3600 : time_s; }));
  EXPECT_THAT(info(bag)["problems"].dump(), HasSubstr("clock jumps once"));
  const Outcome run = slam(bag);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("the clock jumps once: of 2 segments number 2 is used"));
  const auto report = nlohmann::json::parse(run.out)["report"];
  const double recorded_s = nlohmann::json::parse(rayfield({"info", log_.bag, "--json", "-q"}).out)["duration_s"];
  EXPECT_NEAR(report["duration_s"].get<double>(), recorded_s - 20, 0.5);
  EXPECT_EQ(report["georeferenced"], true);
}

TEST_F(BadLog, SensorsThatMeasureNothingAreRefused) {
  const auto all = [](float value) {
    return Damage{.lidar = [value](LidarScan& scan, double) {
      std::fill(scan.range_m.begin(), scan.range_m.end(), value);
      return true;
    }};
  };
  expect_refused(slam(damaged(all(std::nanf("")))), 3, "damaged.bag", "not one of its");
  EXPECT_THAT(info(work_.path("damaged.bag"))["problems"].dump(), HasSubstr("every range is NaN"));
  expect_refused(slam(damaged(all(std::numeric_limits<float>::infinity()))), 3, "damaged.bag", "usable range");
  EXPECT_THAT(info(work_.path("damaged.bag"))["problems"].dump(), HasSubstr("not one return"));
  const std::string no_imu = damaged({.imu = [](ImuSample& sample, double) {
    sample.angular_velocity_rad_s.x() = std::nan("");
    return true;
  }});
  expect_refused(slam(no_imu), 3, "damaged.bag", "/imu/data");
}

TEST_F(BadLog, AnAccelerometerInGIsRefusedAndSeenByInfo) {
  const std::string bag = damaged({.imu = [](ImuSample& sample, double) {
    sample.linear_acceleration_m_s2 /= kGravity_m_s2;
    return true;
  }});
  expect_refused(slam(bag), 3, "damaged.bag", "must be in m/s²");
  EXPECT_THAT(info(bag)["problems"].dump(), HasSubstr("not the 9.8 m/s2 of gravity"));
}

TEST_F(BadLog, AGyroscopeInDegreesIsRefusedAndSeenByInfo) {
  const std::string bag = damaged({.imu = [](ImuSample& sample, double) {
    sample.angular_velocity_rad_s *= 180 / M_PI;
    return true;
  }});
  expect_refused(slam(bag), 3, "damaged.bag", "check the extrinsics, the IMU's units");
  EXPECT_THAT(info(bag)["problems"].dump(), HasSubstr("as if the gyroscope were in degrees"));
}

TEST_F(BadLog, AStuckSpinnerIsRefused) {
  const std::string always = damaged({.spinner = [](SpinnerAngle& angle, double) {
    angle.angle_rad = 0.3;
    return true;
  }});
  expect_refused(slam(always), 3, "damaged.bag", "stuck");
  EXPECT_THAT(info(always)["problems"].dump(), HasSubstr("no joint goes round"));

  double last_rad = 0;
  const std::string midway = damaged({.spinner = [&](SpinnerAngle& angle, double elapsed_s) {
    if (elapsed_s > 20) angle.angle_rad = last_rad;
    last_rad = angle.angle_rad;
    return true;
  }});
  const Outcome run = slam(midway);
  expect_refused(run, 3, "damaged.bag", "trajectory");
  EXPECT_THAT(run.err, HasSubstr("spinner /spinner/joint_states: stands still for"));
  EXPECT_THAT(info(midway)["problems"].dump(), HasSubstr("joint 'spinner' stands still for"));
}

TEST_F(BadLog, SensorsThatAreNotAwakeTogetherAreSaid) {
  const std::string ends = damaged({.lidar = [](LidarScan&, double elapsed_s) { return elapsed_s < 20; }});
  const Outcome run = slam(ends);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, testing::ContainsRegex("lidar /lidar/scan: ends [0-9.]+ s before the others"));
  EXPECT_LT(nlohmann::json::parse(run.out)["report"]["duration_s"], 20.1);
  std::filesystem::remove(cloud());

  const std::string apart = damaged({.lidar = [](LidarScan& scan, double) {
    scan.time_s += 1000;
    return true;
  }});
  expect_refused(slam(apart), 3, "damaged.bag", "check the clocks");
  EXPECT_THAT(info(apart)["problems"].dump(), HasSubstr("the clocks do not agree"));

  const std::string brief =
      damaged({[](ImuSample&, double s) { return s < 3; }, {}, {}, [](LidarScan&, double s) { return s < 3; }});
  expect_refused(slam(brief), 3, "damaged.bag", "for less than 5 s");
}

// Recording stops mid-chunk, in a header, anywhere: what is whole is used and the loss is said, or the bag is refused.
TEST_F(BadLog, CutAtAnyByteABagGivesWhatIsWholeOrIsRefused) {
  const std::string bytes = read_file(damaged({}));  // simulated logs are compressed; here a part of the bytes counts
  int used = 0;
  const auto run_cut = [&](std::size_t length) {
    SCOPED_TRACE("cut at byte " + std::to_string(length));
    std::filesystem::remove(cloud());
    const Outcome run = slam(put("cut.bag", bytes.substr(0, length)));
    if (run.exit_code != 0) return expect_refused(run, 3, "cut.bag", "rayfield: ");
    ++used;
    EXPECT_EQ(run.error_lines(), 0);
    EXPECT_THAT(run.err, testing::ContainsRegex("warning: [0-9]+ bytes \\(about [0-9.]+ s\\) lost at byte"));
    const auto result = nlohmann::json::parse(run.out);
    EXPECT_THAT(result["warnings"].dump(), HasSubstr("lost at byte"));
    // Sensors write evenly: the part of the bytes is the part of the drive, but for what lies in the cut message.
    const double part = static_cast<double>(length) / static_cast<double>(bytes.size());
    const double whole_s = 65.8;
    EXPECT_NEAR(result["report"]["duration_s"].get<double>(), part * whole_s, 1.0);
  };
  for (const std::size_t length : {1U, 12U, 13U, 20U, 100U, 4096U, 4117U, 4118U, 4200U, 9000U, 200000U})
    run_cut(length);
  EXPECT_EQ(used, 0) << "less than five seconds cannot be registered";
  const auto run_part = [&](double part) {
    run_cut(static_cast<std::size_t>(part * static_cast<double>(bytes.size())));
  };
  run_part(0.13);
  EXPECT_EQ(used, 0) << "fixes that span less than 8 m do not place a drive";
  for (const double part : {0.2718, 0.29, 0.31416}) run_part(part);
  EXPECT_EQ(used, 3);
}

TEST_F(BadLog, AnUnclosedRecordingIsALogWhateverItIsCalled) {
  const std::string bytes = read_file(log_.bag);
  for (const char* name : {"scan.bag.active", "scan"}) {
    const auto document = info(put(name, bytes.substr(0, bytes.size() / 3)));
    EXPECT_EQ(document["kind"], "log") << name;
    EXPECT_THAT(document["problems"].dump(), HasSubstr("lost at byte")) << name;
  }
}

TEST_F(BadLog, NamesInALogReachTheTerminalWithoutControlCharacters) {
  std::string bytes = read_file(log_.bag);
  for (std::size_t at = 0; (at = bytes.find("/gps/fix", at)) != std::string::npos; ++at)
    bytes.replace(at, 8, "/g\x1b[31mx");
  const Outcome run = rayfield({"info", put("colour.bag", bytes)});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("/g?[31mx"));
  EXPECT_EQ((run.out + run.err).find('\x1b'), std::string::npos);
}

TEST_F(BadLog, WhatWasLostOfALogStaysWithItsScan) {
  const std::string bytes = read_file(log_.bag), store = work_.path("block");
  const std::string bag = put("cut.bag", bytes.substr(0, bytes.size() / 2));
  ASSERT_EQ(rayfield({"init", store, "--crs", "EPSG:32632"}).exit_code, 0);
  const Outcome add = rayfield({"add", store, bag, "--rig", log_.rig, "--date", "2021-07-01", "--json"});
  ASSERT_EQ(add.exit_code, 0) << add.err;
  EXPECT_THAT(nlohmann::json::parse(add.out)["warnings"].dump(), HasSubstr("lost at byte"));
  EXPECT_THAT(rayfield({"status", store, "--json"}).out, HasSubstr("lost at byte"));
}

TEST_F(BadLog, CtrlCEndsWith130AndLeavesNoCloud) {
  const std::vector<std::string> command{"slam", log_.bag, "--rig", log_.rig, "-o", cloud(), "--progress", "plain"};
  for (const char* stage : {"reading log: ", "windowed registration: "}) {
    const Outcome run = rayfield_interrupted_at(command, stage);
    EXPECT_EQ(run.exit_code, 130) << stage << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr("run the same command again"));
    EXPECT_EQ(clouds_left(), 0);
  }
}

}  // namespace
}  // namespace rayfield::test
