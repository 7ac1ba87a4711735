#include "rayfield/formats/trajectory_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "formats/vehicle/bzip2_text.h"
#include "tests/formats/bag_bytes.h"

namespace rayfield::formats {
namespace {

using ::testing::HasSubstr;

Result<TrajectoryFile> read(const std::string& text) {
  const bytes::TemporaryFile file(text, ".tum");
  return read_trajectory(file.path());
}

TEST(TrajectoryFile, RoundTripsPosesCrsAndFrame) {
  TrajectoryFile trajectory;
  trajectory.crs = "EPSG:7854";
  trajectory.frame = "IMU";
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  for (int i = 0; i < 1000; ++i) {
    trajectory.poses.push_back({1549843200.01 + 0.01 * i, {turned, {276543.123456 + i, 6099876.654321, 82.5}}});
  }
  const bytes::TemporaryFile file("", ".tum");
  ASSERT_TRUE(write_trajectory(file.path(), trajectory));
  const auto again = read_trajectory(file.path());
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(again->crs, "EPSG:7854");
  EXPECT_EQ(again->frame, "IMU");
  ASSERT_EQ(again->poses.size(), 1000U);
  for (std::size_t i = 0; i < 1000; ++i) {
    EXPECT_NEAR(again->poses[i].time_s, trajectory.poses[i].time_s, 2.4e-7);
    EXPECT_LT((again->poses[i].map_from_body.translation - trajectory.poses[i].map_from_body.translation).norm(), 1e-6);
    EXPECT_LT(again->poses[i].map_from_body.rotation.angularDistance(turned), 1e-7);
  }
}

// A drive at 1.2 m/s over rough ground, 100 poses a second.
TrajectoryFile rough_drive(int count) {
  TrajectoryFile trajectory;
  trajectory.crs = "EPSG:7854";
  trajectory.frame = "IMU";
  for (int i = 0; i < count; ++i) {
    const double t = 0.01 * i;
    const Eigen::Vector3d p(276543.1 + 1.2 * t, 6099876.6 + 0.03 * std::sin(7.1 * t), 82.5 + 0.02 * std::sin(23.3 * t));
    const Eigen::Quaterniond q = Eigen::AngleAxisd(0.4 + 0.02 * std::sin(5.7 * t), Eigen::Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(0.03 * std::sin(19.1 * t), Eigen::Vector3d::UnitX());
    trajectory.poses.push_back({1549843200.0 + t, {q, p}});
  }
  return trajectory;
}

TEST(TrajectoryFile, APackedTrajectoryKeepsEveryPoseToWhatRaysNeedInAFourthOfTheBytes) {
  const TrajectoryFile trajectory = rough_drive(6000);
  const auto packed = pack_trajectory(trajectory);
  ASSERT_TRUE(packed) << packed.error().line();
  const bytes::TemporaryFile plain("", ".tum"), file(*packed, ".tum.bz2");
  ASSERT_TRUE(write_trajectory(plain.path(), trajectory));
  EXPECT_LT(static_cast<double>(packed->size()), 0.25 * static_cast<double>(std::filesystem::file_size(plain.path())));
  const auto again = read_trajectory(file.path());
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(again->crs, "EPSG:7854");
  ASSERT_EQ(again->poses.size(), trajectory.poses.size());
  for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
    const TimedPose &a = again->poses[i], &b = trajectory.poses[i];
    EXPECT_NEAR(a.time_s, b.time_s, 1e-6);
    const Eigen::Vector3d far_end(0, 40, 0);
    EXPECT_LT((a.map_from_body * far_end - b.map_from_body * far_end).norm(), 2e-5) << "of a ray of 40 m";
  }
}

TEST(TrajectoryFile, RefusesPackedFilesThatAreDamagedCutOrBombs) {
  const std::string good = *pack_trajectory(rough_drive(500));
  const auto expect_refused = [](const std::string& text, const char* why) {
    const auto trajectory = read(text);
    ASSERT_FALSE(trajectory) << why;
    EXPECT_EQ(trajectory.error().code, ErrorCode::bad_input);
    EXPECT_THAT(trajectory.error().line(), HasSubstr(why));
  };
  expect_refused(good.substr(0, good.size() / 2), "ends early");
  std::string damaged = good;
  damaged[good.size() / 2] = static_cast<char>(damaged[good.size() / 2] ^ 4);
  expect_refused(damaged, "damaged");
  const auto bomb = pack_text(std::string(200'000'000, '\n'));
  ASSERT_TRUE(bomb);
  expect_refused(*bomb, "far more");
}

TEST(TrajectoryFile, ReadsPlainTumWithTabsCommentsAndWindowsLineEnds) {
  const auto trajectory = read("# anything\r\n\r\n1 2 3 4 0 0 0 1\r\n  2.5\t2 3 -4e-1 0 0 1 0 \n\n3 0 0 0 0 0 0 1");
  ASSERT_TRUE(trajectory) << trajectory.error().line();
  ASSERT_EQ(trajectory->poses.size(), 3U);
  EXPECT_EQ(trajectory->poses[1].time_s, 2.5);
  EXPECT_EQ(trajectory->poses[1].map_from_body.translation.z(), -0.4);
  EXPECT_EQ(trajectory->poses[1].map_from_body.rotation.z(), 1.0);
  EXPECT_TRUE(trajectory->crs.empty());
}

TEST(TrajectoryFile, RefusesBadLinesWithTheirNumber) {
  const std::string good = "# c\n1 0 0 0 0 0 0 1\n";
  for (const char* line :
       {"2 0 0 0 0 0 0", "2 0 0 0 0 0 0 1 5", "2 0 0 x 0 0 0 1", "2 0 0 nan 0 0 0 1", "2,0,0,0,0,0,0,1"}) {
    const auto trajectory = read(good + line + "\n");
    ASSERT_FALSE(trajectory) << line;
    EXPECT_EQ(trajectory.error().code, ErrorCode::bad_input);
    EXPECT_THAT(trajectory.error().line(), HasSubstr("line 3: not the eight numbers"));
  }
  EXPECT_THAT(read(good + "1 0 0 0 0 0 0 1\n").error().line(), HasSubstr("line 3: the time is not later"));
  EXPECT_THAT(read(good + "2 0 0 0 0 0 0 1.1\n").error().line(), HasSubstr("line 3: the quaternion is not unit"));
  for (const char* line : {"2 1e300 0 0 0 0 0 1", "2 0 -2e8 0 0 0 0 1", "2 0 0 2e5 0 0 0 1", "1e300 0 0 0 0 0 0 1"})
    EXPECT_THAT(read(good + line + "\n").error().line(), HasSubstr("line 3: its time or place is none on Earth"));
  EXPECT_THAT(read(good + std::string(5000, ' ') + "\n").error().line(), HasSubstr("longer than 4096"));
  EXPECT_THAT(read("# only comments\n").error().line(), HasSubstr("no poses"));
  EXPECT_THAT(read("").error().line(), HasSubstr("no poses"));
}

TEST(TrajectoryFile, DoesNotWriteWhatItCouldNotRead) {
  const bytes::TemporaryFile file("before", ".tum");
  TrajectoryFile bad;
  bad.poses = {{2, {}}, {1, {}}};
  EXPECT_EQ(write_trajectory(file.path(), bad).error().code, ErrorCode::usage);
  bad.poses = {{1, {Eigen::Quaterniond::Identity(), {bytes::kNaN, 0, 0}}}};
  EXPECT_EQ(write_trajectory(file.path(), bad).error().code, ErrorCode::usage);
  bad.poses = {{1, {}}};
  bad.crs = "a\nb";
  EXPECT_EQ(write_trajectory(file.path(), bad).error().code, ErrorCode::usage);
  EXPECT_EQ(bytes::read_file(file.path()), "before");
}

}  // namespace
}  // namespace rayfield::formats
