#include "formats/las/time_match.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rayfield::formats {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kDrive_s = 1549843200;                     // 2019-02-11T00:00:00Z, a Monday
constexpr double kAdjusted_s = kDrive_s - 1315964800 + 18;  // the same moment by the other clocks
constexpr double kWeek_s = 86400 + 18;
constexpr TimeSpan kUnixSpan{kDrive_s, kDrive_s + 600};

std::vector<double> from(double start_s) { return {start_s, start_s + 100, start_s + 599.5}; }

TEST(TimeMatch, TakesTimesOfOneClockAsTheyAre) {
  const auto match = match_times(from(kDrive_s), false, kUnixSpan, 0.01);
  ASSERT_TRUE(match) << match.error().line();
  EXPECT_EQ(match->trajectory_time(kDrive_s + 5), kDrive_s + 5);
  EXPECT_EQ(match->to_unix_s, 0);
  EXPECT_EQ(match->inside, 1);
  EXPECT_THAT(match->text, HasSubstr("one clock, Unix time"));
}

TEST(TimeMatch, AdjustedGpsTimeIsUnixTimeWithLeapSeconds) {
  const auto match = match_times(from(kAdjusted_s), true, kUnixSpan, 0.01);
  ASSERT_TRUE(match) << match.error().line();
  EXPECT_NEAR(match->trajectory_time(kAdjusted_s + 5), kDrive_s + 5, 1e-6);
  EXPECT_THAT(match->text, HasSubstr("18 leap seconds"));
  // In 2016 there had been 17.
  const double new_year_s = 1483228800;
  const auto before =
      match_times(from(new_year_s - 700 - 1315964800 + 17), true, {new_year_s - 700, new_year_s - 100}, 0.01);
  ASSERT_TRUE(before) << before.error().line();
  EXPECT_NEAR(before->trajectory_time(new_year_s - 650 - 1315964800 + 17), new_year_s - 650, 1e-6);
}

TEST(TimeMatch, ForgivesABitThatTheWriterForgot) {
  const auto match = match_times(from(kAdjusted_s), false, kUnixSpan, 0.01);
  ASSERT_TRUE(match) << match.error().line();
  EXPECT_NEAR(match->trajectory_time(kAdjusted_s), kDrive_s, 1e-6);
  EXPECT_THAT(match->text, HasSubstr("its header says seconds of the week"));
  const auto week = match_times(from(kWeek_s), true, kUnixSpan, 0.01);
  ASSERT_TRUE(week) << week.error().line();
  EXPECT_NEAR(week->trajectory_time(kWeek_s), kDrive_s, 1e-6);
  EXPECT_THAT(week->text, HasSubstr("its header says adjusted"));
}

TEST(TimeMatch, SecondsOfTheWeekAreThoseOfTheTrajectorysWeek) {
  const auto match = match_times(from(kWeek_s), false, kUnixSpan, 0.01);
  ASSERT_TRUE(match) << match.error().line();
  EXPECT_NEAR(match->trajectory_time(kWeek_s + 30), kDrive_s + 30, 1e-6);
  EXPECT_EQ(match->to_unix_s, 0);
}

TEST(TimeMatch, ADriveOverTheEndOfTheWeekRunsOnOrBeginsAnew) {
  const double end_s = kDrive_s - kWeek_s + 604800;  // of that week, Unix
  const TimeSpan span{end_s - 300, end_s + 300};
  const std::vector<double> rolled = {604800 - 200, 604800 - 100, 100, 200}, running = {604800 - 200, 604800 + 200};
  for (const std::vector<double>& times : {rolled, running}) {
    const auto match = match_times(times, false, span, 0.01);
    ASSERT_TRUE(match) << match.error().line();
    EXPECT_EQ(match->inside, 1);
    EXPECT_NEAR(match->trajectory_time(604800 - 200), end_s - 200, 1e-6);
    EXPECT_NEAR(match->trajectory_time(times.back()), end_s + 200, 1e-6);
  }
}

TEST(TimeMatch, ATrajectoryInSecondsOfTheWeekFindsCloudsInGpsTimeAndTheirUnixTime) {
  const auto match = match_times(from(kAdjusted_s), true, {kWeek_s, kWeek_s + 600}, 0.01);
  ASSERT_TRUE(match) << match.error().line();
  EXPECT_NEAR(match->trajectory_time(kAdjusted_s + 5), kWeek_s + 5, 1e-6);
  EXPECT_NEAR(match->trajectory_time(kAdjusted_s + 5) + match->to_unix_s, kDrive_s + 5, 1e-6);
}

TEST(TimeMatch, TheSameGpsTimeInBothBecomesUnixTimeIfTheCloudSaysWhichItIs) {
  const auto match = match_times(from(kAdjusted_s), true, {kAdjusted_s, kAdjusted_s + 600}, 0.01);
  ASSERT_TRUE(match) << match.error().line();
  EXPECT_EQ(match->trajectory_time(kAdjusted_s), kAdjusted_s);
  EXPECT_NEAR(kAdjusted_s + match->to_unix_s, kDrive_s, 1e-6);
  const auto undated = match_times(from(kWeek_s), false, {kWeek_s, kWeek_s + 600}, 0.01);
  ASSERT_TRUE(undated) << undated.error().line();
  EXPECT_FALSE(undated->has_date);
}

TEST(TimeMatch, NamesBothSpansWhereNoClockFits) {
  for (const bool says_adjusted : {false, true}) {
    const auto match = match_times(from(kAdjusted_s - 86400), says_adjusted, kUnixSpan, 0.01);
    ASSERT_FALSE(match);
    EXPECT_EQ(match.error().code, ErrorCode::bad_input);
    EXPECT_THAT(match.error().line(), HasSubstr("cloud's times are 233792018 to 233792617.5"));
    EXPECT_THAT(match.error().line(), HasSubstr("1549843200 to 1549843800 (2019-02-11T00:00:00.000Z to"));
  }
  EXPECT_THAT(match_times(from(kAdjusted_s - 86400), true, kUnixSpan, 0.01).error().line(),
              HasSubstr("(adjusted standard GPS time: 2019-02-10T00:00:00.000Z"));
}

TEST(TimeMatch, LooksAtFiniteTimesOnly) {
  const std::vector<double> none = {std::nan(""), INFINITY};
  EXPECT_THAT(match_times(none, true, kUnixSpan, 0.01).error().line(), HasSubstr("none of its points has a time"));
  const auto some = match_times(std::vector<double>{std::nan(""), kDrive_s, -INFINITY}, true, kUnixSpan, 0.01);
  ASSERT_TRUE(some);
  EXPECT_EQ(some->inside, 1);
}

}  // namespace
}  // namespace rayfield::formats
