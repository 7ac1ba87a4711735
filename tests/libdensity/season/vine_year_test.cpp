#include "libdensity/season/vine_year.h"

#include <gtest/gtest.h>

namespace rayfield::density {
namespace {

constexpr double kSouth = -35, kNorth = 47;

TEST(LeaflessSeason, IsJuneToTenSeptemberInTheSouthAndHalfAYearLaterInTheNorth) {
  for (const char* date : {"2019-06-01", "2019-07-31", "2019-09-10"}) {
    EXPECT_TRUE(is_leafless_season(date, kSouth)) << date;
    EXPECT_FALSE(is_leafless_season(date, kNorth)) << date;
  }
  for (const char* date : {"2019-12-01", "2020-01-31", "2020-02-29", "2020-03-10"}) {
    EXPECT_TRUE(is_leafless_season(date, kNorth)) << date;
    EXPECT_FALSE(is_leafless_season(date, kSouth)) << date;
  }
  for (const char* date : {"2019-05-31", "2019-09-11", "2019-11-30", "2019-03-11"})
    for (const double latitude : {kSouth, kNorth}) EXPECT_FALSE(is_leafless_season(date, latitude)) << date;
}

TEST(LeaflessSeason, IsNeverNearTheEquator) {
  for (const double latitude : {-20.0, -5.0, 0.0, 12.0, 20.0})
    for (const char* date : {"2019-07-15", "2019-01-15"}) EXPECT_FALSE(is_leafless_season(date, latitude));
  EXPECT_TRUE(is_leafless_season("2019-07-15", -20.1));
  EXPECT_TRUE(is_leafless_season("2019-01-15", 20.1));
}

TEST(FullLeafSeason, IsSummerAndNeverNearTheEquator) {
  for (const char* date : {"2019-12-01", "2020-02-29"}) {
    EXPECT_TRUE(is_full_leaf_season(date, kSouth)) << date;
    EXPECT_FALSE(is_full_leaf_season(date, kNorth)) << date;
    EXPECT_FALSE(is_full_leaf_season(date, -12)) << date;
  }
  for (const char* date : {"2019-06-01", "2019-08-31"}) EXPECT_TRUE(is_full_leaf_season(date, kNorth)) << date;
  for (const char* date : {"2019-11-30", "2020-03-01"}) EXPECT_FALSE(is_full_leaf_season(date, kSouth)) << date;
}

TEST(Latitude, IsThatOfTheMiddleOfTheScan) {
  tile::ScanEntry entry;
  EXPECT_EQ(latitude_of(entry, "EPSG:7854"), std::nullopt) << "nothing was scanned";
  entry.origin_bounds = {Eigen::Vector3d(276100, 6099900, 80), Eigen::Vector3d(276200, 6100000, 90)};
  ASSERT_TRUE(latitude_of(entry, "EPSG:7854"));
  EXPECT_NEAR(*latitude_of(entry, "EPSG:7854"), -35.22, 0.01);
  EXPECT_EQ(latitude_of(entry, "EPSG:4326"), std::nullopt);
}

}  // namespace
}  // namespace rayfield::density
