#include "rayfield/formats/scale_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace rayfield::formats {
namespace {

// `count` cells evenly from 0 to `top`.
std::vector<float> cells(double top, int count = 10'000) {
  std::vector<float> values;
  for (int i = 1; i <= count; ++i) values.push_back(static_cast<float>(top * i / count));
  return values;
}

double end_of(const std::vector<std::vector<float>>& dates, const char* product = "plan_density") {
  ScaleFit fit(product);
  for (const std::vector<float>& date : dates) {
    fit.add(date);
    fit.end_date();
  }
  EXPECT_EQ(fit.scale().low, 0);
  return fit.scale().high;
}

TEST(ScaleFit, EndsAtTheNextRoundValueThatOneInAHundredCellsMayExceed) {
  EXPECT_EQ(end_of({cells(9.9)}), 10);
  EXPECT_EQ(end_of({cells(10.05)}), 10) << "0.5 % are above 10";
  EXPECT_EQ(end_of({cells(10.2)}), 15) << "2 % are above 10";
  EXPECT_EQ(end_of({cells(28)}), 30);
  EXPECT_EQ(end_of({cells(2.9)}, "canopy_height"), 3);
}

TEST(ScaleFit, ABareBlockHasTheScaleOfAUsualCanopyInLeaf) {
  EXPECT_EQ(end_of({}), 5);
  EXPECT_EQ(end_of({cells(0.3)}), 5);
  EXPECT_EQ(end_of({cells(0.3), cells(4)}), 5) << "and keeps it through the season";
}

TEST(ScaleFit, OnlyADateThatExceedsItMovesIt) {
  EXPECT_EQ(end_of({cells(4), cells(9)}), 10);
  EXPECT_EQ(end_of({cells(9), cells(4)}), 10) << "the order of dates does not matter";
  EXPECT_EQ(end_of({cells(9), cells(4), cells(9.5), cells(0.1)}), 10);
  EXPECT_EQ(end_of({cells(0.1, 1'000'000), cells(9, 1000)}), 10) << "many bare cells do not hide a full date";
}

TEST(ScaleFit, DoesNotDependOnTheOrderOfCellsNorOnWhatIsNoCanopy) {
  std::vector<float> values = cells(10.2);
  std::shuffle(values.begin(), values.end(), std::mt19937(1));
  EXPECT_EQ(end_of({values}), 15);
  values.insert(values.end(), 100'000, 0.0F);
  values.insert(values.end(), 100'000, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(end_of({values}), 15) << "bare soil is no canopy of density 0";
}

TEST(ScaleFit, GroundIsInWholeMetresAroundAllDates) {
  ScaleFit fit("ground");
  for (const double height : {82.3, 84.1, 81.9}) {
    fit.add(height);
    fit.end_date();
  }
  EXPECT_EQ(fit.scale().low, 81);
  EXPECT_EQ(fit.scale().high, 85);
  EXPECT_EQ(fit.scale().ramp, Ramp::terrain);
}

}  // namespace
}  // namespace rayfield::formats
