#include "formats/sensor_log/reorder_buffer.h"

// Stamps of a log: their order, jumps and absence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/formats/sensor_log_support.h"

namespace rayfield::formats {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ReorderBuffer, PutsMessagesBackInOrderWithinTheWindow) {
  Collected got;
  LogOptions options = any_sensors();
  options.reorder_window_s = 0.5;
  // 1.2 comes after 1.3 (within the window); 1.0 comes after 1.6 was due (too late).
  const auto report = read(connections() + imu_at(0.9) + imu_at(1.3, 1.2) + imu_at(1.2, 1.3) + imu_at(1.6) +
                               imu_at(2.6) + imu_at(1.0, 2.7) + imu_at(2.8),
                           lidar_rig(), got, options);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(times_of(got), (std::vector<double>{0.9, 1.2, 1.3, 1.6, 2.6, 2.8}));
  EXPECT_EQ(report->topic(SensorKind::imu).late + report->topic(SensorKind::imu).stray_stamps, 1U);
  EXPECT_GE(report->topic(SensorKind::imu).reordered, 1U);
}

TEST(ReorderBuffer, DeliversADuplicateOnce) {
  Collected got;
  const std::string same_scan = scan(5, 0, {}, {1.0, 2.0});
  const auto report = read(connections() + imu_at(1) + imu_at(1) + imu_at(2) + message(3, 5, 0, same_scan) +
                               message(3, 5, 1, same_scan) + message(3, 5, 2, scan(5, 0, {}, {3.0, 4.0})),
                           lidar_rig(), got);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_THAT(times_of(got), ElementsAre(1, 2));
  EXPECT_EQ(got.scans.size(), 2U);  // a lidar may send two different messages of one stamp
  EXPECT_EQ(report->topic(SensorKind::imu).duplicates, 1U);
  EXPECT_EQ(report->topic(SensorKind::lidar).duplicates, 1U);
}

// At 1.7·10⁹ s doubles are 238 ns apart.
TEST(ReorderBuffer, TakesStampsThatAreTheSameInSecondsForOne) {
  constexpr std::uint32_t kSeconds = 1'700'000'000;
  std::string records = connections();
  for (const std::uint32_t stamp_ns : {1'000'000U, 1'000'040U, 1'000'500U, 2'000'000U})
    records += message(0, kSeconds, 2'000'000, imu(kSeconds, stamp_ns));
  Collected got;
  const auto report = read(records, lidar_rig(), got, any_sensors());
  ASSERT_TRUE(report) << report.error().line();
  ASSERT_EQ(got.imus.size(), 3U);
  for (std::size_t i = 1; i < got.imus.size(); ++i) EXPECT_LT(got.imus[i - 1].time_s, got.imus[i].time_s);
  EXPECT_EQ(report->topic(SensorKind::imu).duplicates, 1U);
}

TEST(ReorderBuffer, LeavesOutASingleStrayStamp) {
  for (const double stray : {2.0, 9000.0}) {
    Collected got;
    std::string records = connections();
    for (int i = 0; i < 10; ++i) records += imu_at(i == 5 ? stray : 1000 + i, 1000 + i);
    const auto report = read(records, lidar_rig(), got, any_sensors());
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_EQ(got.imus.size(), 9U) << stray;
    EXPECT_EQ(report->topic(SensorKind::imu).stray_stamps, 1U) << stray;
    EXPECT_EQ(report->segments.size(), 1U) << stray;
  }
}

TEST(ReorderBuffer, LeavesOutAStrayStampAtTheVeryBeginning) {
  Collected got;
  std::string records = connections();
  for (int i = 0; i < 10; ++i) records += imu_at(i == 0 ? 5.0 : 1000 + 0.01 * i, 1000 + 0.01 * i);
  const auto report = read(records, lidar_rig(), got, any_sensors());
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(got.imus.size(), 9U);
  EXPECT_EQ(report->segments.size(), 1U);
}

TEST(ReorderBuffer, CutsTheLogWhereTheClockJumpsAndDeliversTheChosenSegment) {
  for (const double jump : {3600.0, -3600.0}) {
    std::string records = connections();
    for (int i = 0; i < 10; ++i)
      records += imu_at(10000 + i) + message(3, 10000U + static_cast<unsigned>(i), 1,
                                             scan(10000U + static_cast<unsigned>(i), 0, {}, {1.0}));
    for (int i = 10; i < 40; ++i) {
      const double t = 10000 + i + jump;
      records +=
          imu_at(t) + message(3, static_cast<std::uint32_t>(t), 1, scan(static_cast<std::uint32_t>(t), 0, {}, {1.0}));
    }
    Collected first, second;
    const auto report = read(records, lidar_rig(), first);
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_EQ(first.imus.size(), 10U);
    EXPECT_EQ(first.scans.size(), 10U);
    ASSERT_EQ(report->segments.size(), 2U);
    EXPECT_EQ(report->longest_segment, 1);
    EXPECT_EQ(report->segments[1].messages, 30U);
    EXPECT_DOUBLE_EQ(report->segments[1].first_s, 10010 + jump);
    EXPECT_EQ(report->topic(SensorKind::imu).other_segments, 30U);
    EXPECT_THAT(report->warnings(),
                ::testing::Contains(HasSubstr("the clock jumps once: of 2 segments number 1 is used")));
    LogOptions options;
    options.segment = 1;
    ASSERT_TRUE(read(records, lidar_rig(), second, options));
    EXPECT_EQ(second.imus.size(), 30U);
    EXPECT_EQ(second.scans.size(), 30U);
  }
}

TEST(ReorderBuffer, DoesNotTakeASilentSensorForAClockJump) {
  Collected got;
  std::string records = connections();
  for (int i = 0; i < 200; ++i) {
    const auto t = static_cast<std::uint32_t>(1000 + i);
    records += imu_at(t) + message(3, t, 1, scan(t, 0, {}, {1.0}));
    if (i < 10 || i > 150) records += message(1, t, 2, fix(t, 0, 0, 45, 1, 1));  // GPS out for 140 s
  }
  const auto report = read(records, full_rig(), got, any_sensors());
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->segments.size(), 1U);
  EXPECT_EQ(got.fixes.size(), 10U + 49U);
  EXPECT_DOUBLE_EQ(report->topic(SensorKind::gps).longest_gap_s, 142.0);
}

TEST(ReorderBuffer, TakesTheRecordingTimeOfMessagesWithoutAStamp) {
  Collected got;
  const auto report = read(connections() + message(0, 5, 500000000, imu(0, 0)), lidar_rig(), got, any_sensors());
  ASSERT_TRUE(report);
  EXPECT_EQ(got.imus.at(0).time_s, 5.5);
  EXPECT_EQ(report->topic(SensorKind::imu).without_stamp, 1U);
}

}  // namespace
}  // namespace rayfield::formats
