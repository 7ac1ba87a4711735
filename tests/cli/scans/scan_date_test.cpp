#include "cli/scans/scan_date.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayfield::cli {
namespace {

using ::testing::HasSubstr;

constexpr double kHour = 3600;
constexpr double kMidnight = 1549843200;  // 2019-02-11T00:00Z
constexpr double kRenmark = 140.7, kMendoza = -68.8, kZurich = 8.4, kKashgar = 76.0;

TEST(ScanDate, AMorningInAustraliaIsTheDayBeforeInUtc) {
  const double morning = kMidnight - 2.5 * kHour;  // 08:00 of the 11th at UTC+10:30
  EXPECT_FALSE(date_warning("2019-02-11", morning, morning + kHour, kRenmark));
  EXPECT_FALSE(date_warning("2019-02-10", morning, morning + kHour, kRenmark)) << "the date of its clock";
  const auto wrong = date_warning("2019-02-12", morning, morning + kHour, kRenmark);
  ASSERT_TRUE(wrong);
  EXPECT_THAT(*wrong, HasSubstr("2019-02-11"));
  EXPECT_THAT(*wrong, HasSubstr("2019-02-10T21:30 UTC"));
  EXPECT_THAT(*wrong, HasSubstr("not on 2019-02-12"));
}

TEST(ScanDate, AnEveningInArgentinaIsTheDayAfterInUtc) {
  const double evening = kMidnight + 0.5 * kHour;  // 21:30 of the 10th at UTC-3
  EXPECT_FALSE(date_warning("2019-02-10", evening, evening + kHour, kMendoza));
  EXPECT_FALSE(date_warning("2019-02-11", evening, evening + kHour, kMendoza));
  EXPECT_TRUE(date_warning("2019-02-09", evening, evening + kHour, kMendoza));
  EXPECT_TRUE(date_warning("2019-02-12", evening, evening + kHour, kMendoza));
}

TEST(ScanDate, AtNoonEveryOtherDayIsWrong) {
  const double noon = kMidnight + 11 * kHour;
  EXPECT_FALSE(date_warning("2019-02-11", noon, noon + kHour, kZurich));
  for (const char* date : {"2019-02-10", "2019-02-12", "2018-02-11", "2019-11-02"})
    EXPECT_TRUE(date_warning(date, noon, noon + kHour, kZurich)) << date;
}

TEST(ScanDate, CivilTimeMayBeHoursOffTheSun) {
  const double late = kMidnight - 7.5 * kHour;  // 00:30 of the 11th in Beijing's time, 21:34 of the 10th by the sun
  EXPECT_FALSE(date_warning("2019-02-11", late, late + 60, kKashgar));
  EXPECT_FALSE(date_warning("2019-02-10", late, late + 60, kKashgar));
}

TEST(ScanDate, ADriveOverMidnightIsOfBothDays) {
  EXPECT_FALSE(date_warning("2019-02-10", kMidnight - 5 * kHour, kMidnight + 5 * kHour, 0));
  EXPECT_FALSE(date_warning("2019-02-11", kMidnight - 5 * kHour, kMidnight + 5 * kHour, 0));
}

TEST(ScanDate, TimesThatAreNoUnixTimesSayNothing) {
  EXPECT_FALSE(date_warning("2019-02-11", 0, 300, kZurich));
  EXPECT_FALSE(date_warning("2019-02-11", 302400, 302700, kZurich)) << "seconds of a GPS week";
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(date_warning("2019-02-11", inf, -inf, kZurich)) << "no ray";
}

class TwoRays : public RaySource {
 public:
  explicit TwoRays(double time_s) : time_s_(time_s) {}
  Result<std::size_t> read(RayBatch& batch, std::size_t) override {
    batch.clear();
    if (done_) return std::size_t{0};
    done_ = true;
    const Eigen::Vector3d place(465000, 6217000, 30);  // Renmark in EPSG:7854
    batch.push(place, place, std::numeric_limits<double>::quiet_NaN(), 0, false);
    batch.push(place, place, time_s_, 0, false);
    return batch.size();
  }
  Result<bool> rewind() override { return false; }
  std::string name() const override { return "two rays"; }
  std::vector<std::string> warnings() const override { return {"its own"}; }

 private:
  double time_s_;
  bool done_ = false;
};

TEST(ScanDate, ASourceWarnsOnceItsRaysWereRead) {
  for (const auto& [date, count] : {std::pair{"2019-02-11", 1U}, std::pair{"2019-02-13", 2U}}) {
    TwoRays source(kMidnight - 2.5 * kHour);
    DatedSource dated(source, date, "EPSG:7854");
    EXPECT_EQ(dated.warnings().size(), 1U) << "nothing was read yet";
    RayBatch batch;
    ASSERT_EQ(dated.read(batch, 10).value(), 2U);
    EXPECT_EQ(dated.warnings().size(), count) << date;
    EXPECT_EQ(dated.warnings().front(), "its own");
  }
}

}  // namespace
}  // namespace rayfield::cli
