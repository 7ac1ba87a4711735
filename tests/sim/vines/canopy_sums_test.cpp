#include "sim/vines/canopy_sums.h"

#include <cmath>

#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

/// A row of two panels of 6.5 m on flat ground, for sheets of leaf that hang along it.
class CanopySumsTest : public ::testing::Test {
 protected:
  /// Upright, facing across the row.
  void hang(TriangleMesh& mesh, double from_m, double to_m, double low_m, double high_m, double offset_m) const {
    mesh.add_quad(ground.row_point(0, from_m, offset_m, low_m), ground.row_point(0, to_m, offset_m, low_m),
                  ground.row_point(0, to_m, offset_m, high_m), ground.row_point(0, from_m, offset_m, high_m));
  }
  RowCanopy described(const TriangleMesh& leaves) const {
    CanopySums sums(ground, 0);
    sums.add_leaves(leaves);
    return sums.finish();
  }

  Site site = bare_site();
  BlockGeometry block{site.rows};
  Terrain terrain{site};
  Ground ground{site, block, terrain};
};

TEST_F(CanopySumsTest, ThreeSheetsAreThreeLayersOfWhichTwoAreExposed) {
  TriangleMesh leaves;
  for (const double offset : {-0.2, 0.0, 0.2}) hang(leaves, 2, 4, 1, 1.5, offset);
  const RowCanopy canopy = described(leaves);
  const CanopyTruth& panel = canopy.panels[0];
  EXPECT_NEAR(panel.leaf_layer_number, 3, 1e-12);
  EXPECT_NEAR(panel.canopy_layer_number, 3, 1e-12);
  EXPECT_NEAR(panel.exposed_leaf_share, 2.0 / 3, 1e-12);
  EXPECT_EQ(panel.porosity, 0);
  EXPECT_NEAR(panel.base_m, 1 + 0.03 * 0.5, 0.01);
  EXPECT_NEAR(panel.height_m, 1 + 0.97 * 0.5, 0.01);
  EXPECT_NEAR(panel.width_m, 0.4, 0.04);
  EXPECT_NEAR(panel.row_gap_share, 1 - 2 / 6.5, 1e-9) << "four half metres of 6.5 m have leaves";
  EXPECT_EQ(canopy.metres[3].row_gap_share, 1);
  EXPECT_EQ(canopy.metres[4].row_gap_share, 0);
  EXPECT_NEAR(canopy.metres[4].leaf_layer_number, 3, 1e-12);
  EXPECT_EQ(canopy.metres[8].height_m, 0);
  EXPECT_TRUE(std::isnan(canopy.metres[8].porosity));
  EXPECT_EQ(canopy.panels[1].row_gap_share, 1);
  EXPECT_TRUE(std::isnan(canopy.panels[1].leaf_layer_number));
}

TEST_F(CanopySumsTest, HalfTheLinesPassBetweenStripesOfOneAndTheSameWidth) {
  TriangleMesh leaves;
  for (int stripe = 0; stripe < 20; ++stripe) hang(leaves, 0.2 * stripe, 0.2 * stripe + 0.1, 1, 1.5, 0);
  const CanopyTruth panel = described(leaves).panels[0];
  EXPECT_NEAR(panel.porosity, 0.5, 1e-12);
  EXPECT_NEAR(panel.leaf_layer_number, 0.5, 1e-12);
  EXPECT_NEAR(panel.exposed_leaf_share, 1, 1e-12) << "a leaf alone on its line";
}

TEST_F(CanopySumsTest, AClosedLimbIsMetOnceAndCountsHalfItsSurface) {
  TriangleMesh leaves, wood;
  hang(leaves, 0, 6, 1, 1.5, 0.3);
  Limb limb;
  limb.from = ground.row_point(0, 0, 0, 1.25), limb.to = ground.row_point(0, 6, 0, 1.25);
  limb.from_diameter_m = limb.to_diameter_m = 0.1, limb.sides = 32;
  add_limb(wood, limb);
  CanopySums sums(ground, 0);
  sums.add_leaves(leaves);
  sums.add_wood(wood, {0, wood.triangles.size()});
  const RowCanopy canopy = sums.finish();
  // Its outline is 0.1 m of the outline's height, which holds 94 % of leaves and wood; lines stand 2 cm apart.
  const double height = canopy.panels[0].height_m - canopy.panels[0].base_m;
  EXPECT_NEAR(canopy.panels[0].canopy_layer_number, 1 + 0.1 / height, 0.03);
  EXPECT_NEAR(canopy.panels[0].leaf_layer_number, 1, 1e-12);
  double wood_m2 = 0, leaf_m2 = 0;
  for (const CanopyBand& band : canopy.profiles[0]) wood_m2 += band.wood_m2, leaf_m2 += band.leaf_m2;
  EXPECT_NEAR(wood_m2, 0.5 * M_PI * 0.1 * 6, 1e-3);
  EXPECT_NEAR(leaf_m2, 3, 1e-4);
}

TEST_F(CanopySumsTest, AProfileHoldsWhatLiesInItsBands) {
  TriangleMesh leaves;
  hang(leaves, 1, 2, 1, 1.5, 0);
  const RowCanopy canopy = described(leaves);
  double below = 0, inside = 0, above = 0;
  for (const CanopyBand& band : canopy.profiles[0])
    (band.high_m < 1.001 ? below : band.low_m > 1.499 ? above : inside) += band.leaf_m2;
  EXPECT_NEAR(inside, 0.5, 0.01);
  EXPECT_NEAR(below + above, 0, 0.01);
}

TEST(CanopyOfAWorld, IndependentLeavesAreMissedByAsManyLinesAsPoissonNumbersWant) {
  Site site = small_site();
  site.canopy.vigour_variation = site.canopy.vine_variation = 0;
  site.structure.trunk_diameter_m = site.structure.cordon_diameter_m = site.structure.canes_per_m = 0;
  site.structure.wire_heights_m.clear();
  const World world = make_world(site);
  // The density of leaves varies inside the outline, so that more lines are open than exp(−mean), but not many more.
  for (const RowCanopy& row : world.canopy())
    for (const CanopyTruth& panel : row.panels) {
      // A panel's outline is about 5 m², as large as 1500 of its leaves seen from the side: chance is √(P(1−P)/1500).
      EXPECT_GT(panel.porosity, std::exp(-panel.leaf_layer_number) - 3 * 0.013);
      EXPECT_LT(panel.porosity, 1.6 * std::exp(-panel.leaf_layer_number));
      EXPECT_EQ(panel.leaf_layer_number, panel.canopy_layer_number);
    }
}

}  // namespace
}  // namespace rayfield::sim
