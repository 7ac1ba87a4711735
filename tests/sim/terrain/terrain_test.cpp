#include "sim/terrain/terrain.h"

#include <cmath>
#include <numbers>

#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

TEST(Terrain, HasTheSlopeThatIsAskedFor) {
  Site site = bare_site();
  site.terrain.slope_percent = 8;
  site.terrain.slope_azimuth_deg = 60;
  const Terrain terrain(site);
  const Eigen::Vector2d uphill(std::sin(std::numbers::pi / 3), std::cos(std::numbers::pi / 3));
  EXPECT_NEAR(terrain.height(10 * uphill) - terrain.height(-10 * uphill), 1.6, 1e-5);
  EXPECT_NEAR(terrain.height(7 * Eigen::Vector2d(uphill.y(), -uphill.x())), 0, 1e-5);
}

TEST(Terrain, BanksCarryTheRowsAndHaveTheirWidthAtHalfHeight) {
  Site site = bare_site();
  site.terrain.bank_height_m = 0.2;
  site.terrain.bank_width_m = 0.8;
  const Terrain terrain(site);
  const BlockGeometry block(site.rows);
  const Eigen::Vector2d crest = block.row_point(1, 6);
  const Eigen::Vector2d along = block.row_direction(1, 6), right(along.y(), -along.x());
  EXPECT_NEAR(terrain.smooth_height(crest), 0.2, 1e-9);
  EXPECT_NEAR(terrain.smooth_height(crest + 0.4 * right), 0.1, 1e-9);
  EXPECT_NEAR(terrain.smooth_height(crest - 0.4 * right), 0.1, 1e-9);
  // The mesh follows within the sagitta of its 0.15 m cells.
  EXPECT_NEAR(terrain.height(crest), 0.2, 0.01);
}

TEST(Terrain, RoughnessHasItsStandardDeviation) {
  Site site = bare_site();
  site.rows.length_m = 60;
  site.rows.panel_length_m = 6;
  site.terrain.roughness_m = 0.02;
  const Terrain terrain(site);
  double squares = 0;
  int count = 0;
  for (double e = -25; e < 25; e += 0.9)
    for (double n = -10; n < 10; n += 0.9) squares += std::pow(terrain.height({e, n}), 2), ++count;
  // Linear interpolation inside the cells takes a little of the variance.
  EXPECT_NEAR(std::sqrt(squares / count), 0.02, 0.003);
}

}  // namespace
}  // namespace rayfield::sim
