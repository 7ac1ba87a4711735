#include "rayfield/sim/site.h"

#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

TEST(Site, ValidateFindsWhatWasSetInCode) {
  Site site = small_site();
  EXPECT_TRUE(site.validate());
  site.dates[0].speed_m_s = 50;
  const auto result = site.validate();
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().where, "date[0].speed_m_s");
}

TEST(Site, DefaultCrsIsMgaInAustraliaAndUtmElsewhere) {
  EXPECT_EQ(default_crs(-35.2, 138.5), "EPSG:7854");
  EXPECT_EQ(default_crs(-33.1, 149.0), "EPSG:7855");
  EXPECT_EQ(default_crs(-41.5, 173.9), "EPSG:32759");
  EXPECT_EQ(default_crs(44.8, -0.55), "EPSG:32630");
  EXPECT_EQ(default_crs(36.6, -119.9), "EPSG:32611");
}

}  // namespace
}  // namespace rayfield::sim
