#include "libdensity/integration/descriptors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "libdensity/integration/integrate.h"
#include "tests/libdensity/random_row.h"

namespace rayfield::density {
namespace {

using testing::random_row;

constexpr double kRowLength = 4.8;  // 40 voxels of 0.12 m

/// Layers 2…5 and across 3…6 hold 4 m²/m³, the rest nothing: 0.54 to 1.02 m above the ground, 0.48 m thick.
RowDensity slab() {
  RowDensity row = random_row(1);
  for (int a = 0; a < row.n_along; ++a)
    for (int c = 0; c < row.n_across; ++c)
      for (int u = 0; u < row.n_up; ++u)
        row.density[row.index(a, c, u)] = u >= 2 && u < 6 && c >= 3 && c < 7 ? 4.0F : 0.0F;
  return row;
}

void clear(RowDensity& row, double from_m, double to_m) {
  for (int a = 0; a < row.n_along; ++a) {
    const double chainage = row.chainage_m[static_cast<std::size_t>(a)];
    if (chainage < from_m || chainage >= to_m) continue;
    for (int c = 0; c < row.n_across; ++c)
      for (int u = 0; u < row.n_up; ++u) row.density[row.index(a, c, u)] = 0;
  }
}

const std::vector<Panel> kWhole = {{1, 1, 0, kRowLength}};

struct Described {
  std::vector<PanelValue> panels;
  std::vector<RowMetreProduct> metres;
};

/// As the results of a scan are made.
Described describe(const RowDensity& row, const DescriptorSettings& settings = {},
                   const std::vector<Panel>& panels = kWhole) {
  Described out;
  out.panels = integrate_panels(row, panels, 2.5, {});
  out.metres = row_metres(row, kRowLength, {});
  const auto outline = canopy_outline(row, kRowLength, settings);
  put_outline(outline, out.metres);
  const RowLines lines(row, kRowLength, outline, settings);
  lines.describe_panels(panels, out.panels);
  lines.describe_metres(out.metres);
  return out;
}

TEST(Descriptors, AUniformSlabHasTheClosedForms) {
  const Described slab_is = describe(slab());
  const double contacts = 0.5 * 4 * 0.48;
  const double open = std::exp(-contacts), one = contacts * open;
  const double exposed = ((1 - open) + (1 - open - one)) / contacts;
  const double zone = 4 * 0.48 * (1.02 - 0.8);
  const CanopyDescriptors& panel = slab_is.panels[0].descriptors;
  EXPECT_NEAR(panel.canopy_base_m, 0.54 + 0.03 * 0.48, 1e-5);
  EXPECT_EQ(panel.row_gap_share, 0);
  EXPECT_NEAR(panel.leaf_layer_number, contacts, 1e-5);
  EXPECT_NEAR(panel.porosity, open, 1e-5);
  EXPECT_NEAR(panel.exposed_leaf_share, exposed, 1e-5);
  EXPECT_NEAR(panel.fruit_zone_area_per_m, zone, 1e-5);
  EXPECT_NEAR(panel.fruit_zone_density, zone / (0.4 * 0.96 * 0.48), 1e-4);
  ASSERT_EQ(slab_is.metres.size(), 10U);
  for (const RowMetreProduct& metre : slab_is.metres) {
    EXPECT_NEAR(metre.canopy_height_m, 0.54 + 0.97 * 0.48, 1e-5);
    EXPECT_NEAR(metre.canopy_width_m, 0.96 * 0.48, 1e-5);
    EXPECT_NEAR(metre.descriptors.canopy_base_m, 0.54 + 0.03 * 0.48, 1e-5);
    EXPECT_NEAR(metre.descriptors.leaf_layer_number, contacts, 1e-5);
    EXPECT_NEAR(metre.descriptors.porosity, open, 1e-5);
    EXPECT_EQ(metre.descriptors.row_gap_share, 0);
  }
  EXPECT_NEAR(slab_is.metres[3].descriptors.fruit_zone_area_per_m, zone, 1e-5);
}

TEST(Descriptors, FlatLeavesShowLessOfThemselvesToALevelLine) {
  DescriptorSettings settings;
  settings.projection = 0.25;
  const CanopyDescriptors panel = describe(slab(), settings).panels[0].descriptors;
  EXPECT_NEAR(panel.leaf_layer_number, 0.25 * 4 * 0.48, 1e-5);
  EXPECT_NEAR(panel.porosity, std::exp(-0.25 * 4 * 0.48), 1e-5);
}

TEST(Descriptors, LeafAnglesOfTheVoxelsAreThoseOfTheLines) {
  ProcessOptions options;
  EXPECT_EQ(descriptor_settings(options, options.voxels.leaf_angles).projection, 0.5);
  options.voxels.leaf_angles.type = LeafAngleType::erectophile;
  // Upright leaves (α = 90°) show 2/π to a level line, level ones nothing: G = ∫ (2/π)(1 − cos 2α)·(2/π) sin α dα.
  EXPECT_NEAR(descriptor_settings(options, options.voxels.leaf_angles).projection, 4 / (M_PI * M_PI) * (1 + 1.0 / 3),
              1e-3);
}

TEST(Descriptors, WholeLeavesThatComeAndGoDoNotOpenTheCanopy) {
  // Of each voxel of a wall one voxel thick, Poisson numbers of leaves with mean 1.5: a line meets 0.5·1.5·a/face.
  constexpr double kLeaf = 0.015, kFace = 0.12 * 0.12;
  const double contacts = 0.5 * 1.5 * kLeaf / kFace;
  std::mt19937_64 rng(7);
  std::poisson_distribution<int> leaves(1.5);
  double open = 0, exposed = 0, without = 0;
  constexpr int kRows = 600;
  // Edges that are found by the leaves would go with their chance.
  const std::vector<StretchOutline> outline(10, {true, true, 0.54, 1.74, 0.12});
  for (int i = 0; i < kRows; ++i) {
    RowDensity row = slab();
    row.leaf_size_m2 = kLeaf;
    for (int a = 0; a < row.n_along; ++a)
      for (int c = 0; c < row.n_across; ++c)
        for (int u = 0; u < row.n_up; ++u)
          row.density[row.index(a, c, u)] =
              c == 5 && u >= 2 ? static_cast<float>(leaves(rng) * kLeaf / std::pow(0.12, 3)) : 0.0F;
    const auto panel_of = [&] {
      std::vector<PanelValue> values(1);
      values[0].canopy_width_m = 0.12;
      RowLines(row, kRowLength, outline, {}).describe_panels(kWhole, values);
      return values[0].descriptors;
    };
    const CanopyDescriptors panel = panel_of();
    open += panel.porosity / kRows, exposed += panel.exposed_leaf_share / kRows;
    row.leaf_size_m2 = 0;
    without += panel_of().porosity / kRows;
  }
  const double none = std::exp(-contacts);
  EXPECT_NEAR(open, none, 0.005 * none);
  EXPECT_NEAR(exposed, (2 - 2 * none - contacts * none) / contacts, 0.01);
  EXPECT_GT(without, 1.015 * none) << "exp(−L) of what varies by chance is too open";
}

TEST(Descriptors, AMissingVineIsAGapAndLeavesTheCanopyBesideItAsItIs) {
  RowDensity row = slab();
  clear(row, 1.99, 3.0);
  const Described with_gap = describe(row);
  const CanopyDescriptors& panel = with_gap.panels[0].descriptors;
  for (const std::size_t k : {4U, 5U}) {
    EXPECT_EQ(with_gap.metres[k].descriptors.row_gap_share, 1);
    EXPECT_EQ(with_gap.metres[k].canopy_height_m, 0);
    EXPECT_TRUE(std::isnan(with_gap.metres[k].descriptors.canopy_base_m));
    EXPECT_TRUE(std::isnan(with_gap.metres[k].descriptors.porosity));
    EXPECT_TRUE(std::isnan(with_gap.metres[k].descriptors.leaf_layer_number));
  }
  EXPECT_EQ(with_gap.metres[3].descriptors.row_gap_share, 0);
  // Voxels of 0.12 m do not end at half metres; each counts where its middle is.
  EXPECT_NEAR(panel.row_gap_share, 1.0 / kRowLength, 0.12 / kRowLength);
  EXPECT_NEAR(panel.porosity, std::exp(-0.96), 0.02);
}

TEST(Descriptors, EmptyIsAGapAndUnscannedIsUndefined) {
  RowDensity row = slab();
  std::fill(row.density.begin(), row.density.end(), 0.0F);
  const Described empty = describe(row);
  EXPECT_EQ(empty.panels[0].descriptors.row_gap_share, 1);
  EXPECT_EQ(empty.panels[0].descriptors.fruit_zone_area_per_m, 0);
  EXPECT_TRUE(std::isnan(empty.panels[0].descriptors.porosity));
  EXPECT_TRUE(std::isnan(empty.panels[0].descriptors.fruit_zone_density));
  EXPECT_EQ(empty.metres[0].canopy_height_m, 0);
  EXPECT_EQ(empty.metres[0].canopy_width_m, 0);
  std::fill(row.state.begin(), row.state.end(), VoxelState::unobserved);
  const Described unseen = describe(row);
  for (const CanopyDescriptors* d : {&unseen.panels[0].descriptors, &unseen.metres[0].descriptors})
    for (const double value : {d->canopy_base_m, d->row_gap_share, d->porosity, d->leaf_layer_number,
                               d->exposed_leaf_share, d->fruit_zone_area_per_m, d->fruit_zone_density})
      EXPECT_TRUE(std::isnan(value));
  EXPECT_TRUE(std::isnan(unseen.metres[0].canopy_height_m));
}

TEST(Descriptors, WhereThereAreNoLeavesInsideTheOutlineNoneIsExposed) {
  const RowDensity plants = slab();
  Described bare = describe(plants);
  RowDensity leaves = plants;
  std::fill(leaves.density.begin(), leaves.density.end(), 0.0F);
  const auto outline = outline_of(bare.metres, bare.metres[0].row_number);
  ASSERT_EQ(outline.size(), 10U);
  RowLines(leaves, kRowLength, outline, {}).describe_panels(kWhole, bare.panels);
  EXPECT_EQ(bare.panels[0].descriptors.leaf_layer_number, 0);
  EXPECT_TRUE(std::isnan(bare.panels[0].descriptors.exposed_leaf_share));
  EXPECT_EQ(bare.panels[0].descriptors.fruit_zone_area_per_m, 0);
  EXPECT_EQ(bare.panels[0].descriptors.fruit_zone_density, 0);
  EXPECT_NEAR(bare.panels[0].descriptors.canopy_base_m, 0.54 + 0.03 * 0.48, 1e-5) << "that of the plants";
}

TEST(Descriptors, AStoredOutlineIsTheOneThatWasStored) {
  RowDensity row = slab();
  clear(row, 1.99, 3.0);
  const auto made = canopy_outline(row, kRowLength, {});
  const auto read = outline_of(describe(row).metres, 1);
  ASSERT_EQ(read.size(), made.size());
  for (std::size_t k = 0; k < made.size(); ++k) {
    EXPECT_EQ(read[k].is_seen, made[k].is_seen);
    EXPECT_EQ(read[k].is_canopy, made[k].is_canopy);
    EXPECT_EQ(read[k].height_m, made[k].height_m);
    EXPECT_EQ(std::isnan(read[k].base_m), std::isnan(made[k].base_m));
  }
}

TEST(Descriptors, BandsOfAProfileAddUpToThePanel) {
  const RowDensity row = random_row(9);
  const std::vector<Panel> panels = {{1, 1, 0.5, 2.03}, {1, 2, 2.03, 4.3}};
  const auto values = integrate_panels(row, panels, 2.5, {});
  const auto profiles = vertical_profiles(row, panels, 0.25);
  ASSERT_EQ(profiles.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    double canopy = 0, plant = 0;
    for (const BandAreas& band : profiles[i]) canopy += band.canopy_area_m2, plant += band.plant_area_m2;
    EXPECT_NEAR(canopy, values[i].leaf_area_m2, 1e-9 * canopy);
    EXPECT_NEAR(plant, values[i].plant_area_m2, 1e-9 * plant);
  }
  EXPECT_EQ(profiles[0].front().low_m, 0.25) << "the grid begins at 0.3 m";
  EXPECT_EQ(profiles[0].back().high_m, 1.75) << "and ends at 1.74 m";
}

TEST(Descriptors, ASlabFillsTheBandsItLiesIn) {
  const auto bands = vertical_profiles(slab(), kWhole, 0.25)[0];
  const double per_height = 4 * 0.48 * kRowLength;
  ASSERT_EQ(bands.size(), 6U);
  EXPECT_NEAR(bands[0].canopy_area_m2, 0, 1e-9);  // 0.25 … 0.50 m
  EXPECT_NEAR(bands[1].canopy_area_m2, (0.75 - 0.54) * per_height, 1e-5);
  EXPECT_NEAR(bands[2].canopy_area_m2, 0.25 * per_height, 1e-5);
  EXPECT_NEAR(bands[3].canopy_area_m2, 0.02 * per_height, 1e-5);
  EXPECT_NEAR(bands[4].canopy_area_m2, 0, 1e-9);
}

}  // namespace
}  // namespace rayfield::density
