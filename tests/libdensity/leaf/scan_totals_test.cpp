#include "libdensity/leaf/scan_totals.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace rayfield::density {
namespace {

ScanTotals totals_of_two() {
  ScanTotals totals;
  totals.plant_area_m2 = 21.5, totals.panel_length_m = 12, totals.panels = 3, totals.panels_with_value = 2;
  totals.observed_fraction = 0.9, totals.holds_downward_misses = true;
  totals.thin_plants = {{"a", {10, 12}}, {"b", {11, 14}}};
  return totals;
}

TEST(ScanTotals, AreGivenBack) {
  const ScanTotals totals = totals_of_two();
  const auto read = totals_from_arrays(arrays_from_totals(totals));
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(read->plant_area_per_m(), totals.plant_area_per_m());
  EXPECT_EQ(read->panels, 3);
  EXPECT_EQ(read->panels_with_value, 2);
  EXPECT_EQ(read->observed_fraction, 0.9);
  EXPECT_TRUE(read->holds_downward_misses);
  EXPECT_EQ(read->thin_plants, totals.thin_plants);
}

TEST(ScanTotals, OfAnEarlierVersionKnowNoThinPlants) {
  tile::ArraySet arrays = arrays_from_totals(totals_of_two());
  arrays.columns.erase("thin_plant_area_m2");
  const auto read = totals_from_arrays(arrays);
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->thin_plants.empty());
  EXPECT_EQ(read->plant_area_m2, 21.5);
}

TEST(ScanTotals, WhosePanelsHaveNotOneValueEachAreDamaged) {
  const auto damaged = [](auto change) {
    tile::ArraySet arrays = arrays_from_totals(totals_of_two());
    change(arrays);
    const auto read = totals_from_arrays(arrays);
    return !read && read.error().code == ErrorCode::damaged;
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(damaged([](tile::ArraySet&) {}));
  EXPECT_TRUE(damaged([](tile::ArraySet& a) { a.columns["thin_plant_area_m2"] = std::vector<double>{10}; }));
  EXPECT_TRUE(damaged([](tile::ArraySet& a) { a.columns["thin_plant_high_m2"] = std::vector<double>{1, 2, 3}; }));
  EXPECT_TRUE(damaged([](tile::ArraySet& a) { a.columns["thin_plant_high_m2"] = std::vector<double>{12, kNaN}; }));
  EXPECT_TRUE(damaged([](tile::ArraySet& a) { a.columns.erase("thin_plant_high_m2"); }));
  EXPECT_TRUE(damaged([](tile::ArraySet& a) { a.attributes = "{"; }));
  EXPECT_TRUE(damaged([](tile::ArraySet& a) { a.attributes = R"({"thin_plants": ["a", 2]})"; }));
  EXPECT_TRUE(damaged([](tile::ArraySet& a) { a.columns["plant_area_m2"] = std::vector<double>{}; }));
}

}  // namespace
}  // namespace rayfield::density
