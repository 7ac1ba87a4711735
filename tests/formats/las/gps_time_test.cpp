#include "formats/las/gps_time.h"

#include <gtest/gtest.h>

namespace rayfield::formats {
namespace {

TEST(GpsTime, CountsTheLeapSecondsThatHadBeenByThen) {
  EXPECT_EQ(leap_seconds(0), 0);
  EXPECT_EQ(leap_seconds(1483228799), 17);  // 2016-12-31T23:59:59Z
  EXPECT_EQ(leap_seconds(1483228800), 18);
  EXPECT_EQ(leap_seconds(915148800), 13);  // 1999-01-01
}

TEST(GpsTime, BeginsIn1980AndCountsLeapSeconds) {
  EXPECT_EQ(adjusted_gps_time(315964800), -1e9) << "1980-01-06, when it begins";
  EXPECT_EQ(adjusted_gps_time(362793599), 362793599.0 - 315964800 - 1e9);
  EXPECT_EQ(adjusted_gps_time(362793600), 362793601.0 - 315964800 - 1e9) << "the first leap second";
  EXPECT_EQ(adjusted_gps_time(1316000000), 1316000000.0 - 315964800 + 15 - 1e9) << "September 2011";
}

TEST(GpsTime, OfADayIsThatOfTheSpecification) {
  // 2011-09-14T01:46:25Z has GPS time 10⁹ s: 15 leap seconds had been.
  EXPECT_EQ(adjusted_gps_time(1315964785), 0);
  EXPECT_EQ(unix_time_of_adjusted(0), 1315964785);
}

TEST(GpsTime, ComesBackFromUnixTimeAroundEveryLeapSecond) {
  for (const double leap_s : {362793600.0, 915148800.0, 1435708800.0, 1483228800.0})
    for (const double off_s : {-100.0, -1.0, -0.5, 0.0, 0.25, 1.0, 17.5, 40.0}) {
      const double unix_s = leap_s + off_s;
      EXPECT_DOUBLE_EQ(unix_time_of_adjusted(adjusted_gps_time(unix_s)), unix_s) << leap_s << " " << off_s;
    }
}

}  // namespace
}  // namespace rayfield::formats
