#include "rayfield/core/date.h"

#include <gtest/gtest.h>

namespace rayfield {
namespace {

TEST(ParseDate, TakesCalendarDates) {
  EXPECT_EQ(parse_date("2019-02-11").value(), "2019-02-11");
  EXPECT_TRUE(parse_date("2020-02-29"));
}

TEST(ParseDate, RefusesWhatIsNoDateAsWrongUsage) {
  for (const char* text : {"", "2019-2-11", "2019-02-30", "2019-13-01", "2019-02-29", "11.02.2019", "2019-02-11x",
                           "20a9-02-11", "0000-01-01", "1959-12-31", "3000-01-01"}) {
    const auto result = parse_date(text);
    ASSERT_FALSE(result) << text;
    EXPECT_EQ(result.error().code, ErrorCode::usage);
  }
}

TEST(ParseCalendarDay, GivesYearMonthAndDayOfWhatIsADate) {
  using namespace std::chrono_literals;
  EXPECT_EQ(parse_calendar_day("2019-02-11").value(), 2019y / 2 / 11);
  EXPECT_EQ(parse_calendar_day("2020-02-29").value(), 2020y / 2 / 29);
  EXPECT_EQ(parse_calendar_day("2019-02-29").error().code, ErrorCode::usage);
}

TEST(UtcText, WritesIso8601) {
  EXPECT_EQ(utc_text(0), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(utc_text(1549843200.0), "2019-02-11T00:00:00.000Z");
  EXPECT_EQ(utc_text(-0.001), "1969-12-31T23:59:59.999Z");
  EXPECT_EQ(utc_text(1e300), "invalid time");
}

}  // namespace
}  // namespace rayfield
