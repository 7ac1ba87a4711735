#include "libdensity/leaf/dormant_scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayfield::density {
namespace {

using testing::HasSubstr;

constexpr double kSouth = -35, kNorth = 47;

ScanSeason scan(const std::string& date, std::optional<double> plant_area_per_m,
                std::optional<bool> declared = std::nullopt) {
  return {date, date, declared, plant_area_per_m};
}

std::vector<bool> dormant(const std::vector<ScanSeason>& scans, std::optional<double> latitude_deg) {
  std::vector<bool> out;
  for (const DormantVerdict& verdict : find_dormant_scans(scans, latitude_deg)) out.push_back(verdict.dormant);
  return out;
}

TEST(DormantScans, AreThoseOfTheLeaflessMonthsThatShowLittle) {
  const std::vector<ScanSeason> scans = {scan("2019-07-20", 0.4), scan("2019-10-01", 0.7), scan("2020-02-01", 3.1)};
  EXPECT_EQ(dormant(scans, kSouth), (std::vector<bool>{true, false, false}));
  EXPECT_EQ(dormant(scans, kNorth), (std::vector<bool>{false, false, false})) << "nothing is small against a winter";
  EXPECT_EQ(dormant(scans, 8), (std::vector<bool>{false, false, false}));
  EXPECT_EQ(dormant(scans, std::nullopt), (std::vector<bool>{false, false, false}));
}

TEST(DormantScans, NeedNoOtherScanToBeHeldAgainst) {
  EXPECT_EQ(dormant({scan("2019-07-20", 0.4)}, kSouth), std::vector<bool>{true});
  EXPECT_EQ(dormant({scan("2019-06-20", 0.9), scan("2019-08-20", 0.4)}, kSouth), (std::vector<bool>{true, true}))
      << "between the two the vines were pruned";
}

TEST(DormantScans, AreNotThoseThatShowMoreThanHalfOfFullLeafOrAsMuchAsSpring) {
  const auto evergreen = find_dormant_scans(std::vector{scan("2019-07-20", 1.8), scan("2020-01-10", 3.1)}, kSouth);
  EXPECT_FALSE(evergreen[0].dormant);
  EXPECT_THAT(evergreen[0].reason, HasSubstr("--dormant yes"));
  EXPECT_EQ(dormant({scan("2019-07-20", 1.5), scan("2020-01-10", 3.1)}, kSouth)[0], true);
  EXPECT_EQ(dormant({scan("2019-07-20", 0.5), scan("2019-10-01", 0.7)}, kSouth)[0], true) << "budburst adds little";
  EXPECT_EQ(dormant({scan("2019-07-20", 0.7), scan("2019-10-01", 0.7)}, kSouth)[0], false);
}

TEST(DormantScans, AreNotThoseOfEvergreenOrchardsThatAreAloneInTheirStore) {
  const auto alone = find_dormant_scans(std::vector{scan("2019-07-20", 2.8)}, kSouth);
  EXPECT_FALSE(alone[0].dormant);
  EXPECT_THAT(alone[0].reason, HasSubstr("2.80 m²"));
  EXPECT_THAT(alone[0].reason, HasSubstr("--dormant yes"));
  EXPECT_EQ(dormant({scan("2019-06-20", 2.8), scan("2019-08-20", 2.9)}, kSouth), (std::vector<bool>{false, false}));
  EXPECT_EQ(dormant({scan("2019-07-20", 2.8, true)}, kSouth), std::vector<bool>{true}) << "as declared";
}

TEST(DormantScans, AreNotUndecidedOnesThatHaveNotBeenProcessed) {
  const auto verdicts = find_dormant_scans(std::vector{scan("2019-07-20", std::nullopt)}, kSouth);
  EXPECT_FALSE(verdicts[0].dormant);
  EXPECT_THAT(verdicts[0].reason, HasSubstr("not been processed"));
}

TEST(DormantScans, AreWhatTheUserSays) {
  EXPECT_EQ(dormant({scan("2019-07-20", 0.4, false), scan("2020-01-10", 3.1, true)}, kSouth),
            (std::vector<bool>{false, true}));
  EXPECT_EQ(dormant({scan("2019-10-20", 0.4, true)}, std::nullopt), std::vector<bool>{true});
}

TEST(WoodScan, IsTheDormantOneNearestInTimeBeforeOrAfter) {
  const std::vector<ScanSeason> scans = {scan("2019-07-20", 0.4), scan("2019-10-01", 0.7), scan("2020-02-01", 3.1),
                                         scan("2020-04-20", 1.1), scan("2020-08-01", 0.4)};
  const auto verdicts = find_dormant_scans(scans, kSouth);
  EXPECT_EQ(wood_scan_of(1, scans, verdicts), 0);
  EXPECT_EQ(wood_scan_of(2, scans, verdicts), 4) << "182 days after, 196 before";
  EXPECT_EQ(wood_scan_of(3, scans, verdicts), 4);
  EXPECT_EQ(wood_scan_of(0, scans, verdicts), 0) << "a dormant scan shows its own wood";
  EXPECT_EQ(wood_scan_of(4, scans, verdicts), 4);
}

TEST(WoodScan, IsTheEarlierOfTwoAsNearAndNeverOneThatWasNotProcessed) {
  const std::vector<ScanSeason> scans = {scan("2020-02-11", 3.1), scan("2020-02-21", 0.4, true),
                                         scan("2020-02-01", 0.4, true), scan("2020-02-12", std::nullopt, true)};
  const auto verdicts = find_dormant_scans(scans, kSouth);
  EXPECT_EQ(wood_scan_of(0, scans, verdicts), 2);
}

TEST(WoodScan, IsNothingWithoutADormantScan) {
  const std::vector<ScanSeason> scans = {scan("2019-10-01", 0.7), scan("2020-02-01", 3.1)};
  EXPECT_EQ(wood_scan_of(1, scans, find_dormant_scans(scans, kSouth)), std::nullopt);
}

TEST(BarestScan, ShowsTheLeastOfTheScansOfOneSeason) {
  const std::vector<ScanSeason> scans = {scan("2019-03-01", 0.3), scan("2019-10-01", 0.7), scan("2019-12-01", 2.4),
                                         scan("2020-07-31", 1.2), scan("2020-08-01", 0.2)};
  EXPECT_EQ(barest_scan_of(2, scans, kSouth), 1) << "winter stands between it and what shows less";
  EXPECT_EQ(barest_scan_of(3, scans, kSouth), 1);
  EXPECT_EQ(barest_scan_of(1, scans, kSouth), std::nullopt) << "it is the barest";
  EXPECT_EQ(barest_scan_of(4, scans, kSouth), std::nullopt) << "alone in its season";
  EXPECT_EQ(barest_scan_of(2, scans, kNorth), 0) << "February 2019 to January 2020";
}

TEST(BarestScan, ShowsClearlyLess) {
  const auto barest_of_second = [](double first) {
    return barest_scan_of(1, std::vector{scan("2019-12-01", first), scan("2020-01-01", 2.0)}, kSouth);
  };
  EXPECT_EQ(barest_of_second(1.49), 0);
  EXPECT_EQ(barest_scan_of(0, std::vector{scan("2019-12-01", 0.0)}, kSouth), std::nullopt) << "itself";
  EXPECT_EQ(barest_of_second(1.51), std::nullopt) << "another drive past equal leaves must not change what is known";
}

TEST(BarestScan, IsOfTheHalfYearAroundWhereThereIsNoWinter) {
  const std::vector<ScanSeason> scans = {scan("2019-12-31", 0.2), scan("2020-01-10", 0.5), scan("2020-07-10", 2.0)};
  for (const std::optional<double> latitude : {std::optional<double>(8), std::optional<double>()}) {
    EXPECT_EQ(barest_scan_of(2, scans, latitude), 1);
    EXPECT_EQ(barest_scan_of(1, scans, latitude), 0);
  }
}

TEST(BarestScan, IsTheEarlierOfEqualsAndNeverOneThatWasNotProcessed) {
  const std::vector<ScanSeason> scans = {scan("2019-12-01", 0.7), scan("2019-11-01", 0.7), scan("2019-10-01", {}),
                                         scan("2020-02-01", 2.0)};
  EXPECT_EQ(barest_scan_of(3, scans, kSouth), 1);
  EXPECT_EQ(barest_scan_of(1, scans, kSouth), std::nullopt);
}

}  // namespace
}  // namespace rayfield::density
