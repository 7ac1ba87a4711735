#include "rayfield/sim/world.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "rayfield/sim/random.h"
#include "sim/terrain/terrain.h"
#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// Half the surface of a post above 0.3 m: the mantle and its octagonal cap of the circle's perimeter.
double post_area(double diameter, double height) {
  const double perimeter = std::numbers::pi * diameter;
  const double cap = perimeter * perimeter / (32 * std::tan(std::numbers::pi / 8));
  return 0.5 * (perimeter * (height - 0.3) + cap);
}

TEST(World, LeafAreaOfTheBlockIsTheTargetTimesTheRowLength) {
  Site site = small_site();
  site.canopy.leaf_area_m2_per_m = 2.4;
  const World world = make_world(site);
  double total = 0;
  for (const RowAreas& row : world.areas()) total += sum(row.panels.leaf_m2);
  EXPECT_NEAR(total, 2.4 * 13 * 2, 1e-4 * total);  // vertices are single precision
}

TEST(World, LeafAreaOfARowIsTheSumOfItsVines) {
  const World world = make_world(small_site());
  for (int row = 0; row < 2; ++row) {
    double vines = 0;
    for (const Vine& vine : world.vines())
      if (vine.row == row) vines += vine.leaf_area_m2;
    const RowAreas& areas = world.areas()[static_cast<std::size_t>(row)];
    EXPECT_NEAR(sum(areas.panels.leaf_m2), vines, 1e-4 * vines);
    EXPECT_NEAR(sum(areas.metres.leaf_m2), sum(areas.panels.leaf_m2), 1e-9);
    EXPECT_NEAR(sum(areas.metres.wood_m2), sum(areas.panels.wood_m2), 1e-9);
  }
}

TEST(World, PanelsOfAnEvenCanopyHaveTheTargetPerMetre) {
  Site site = small_site();
  site.canopy.vigour_variation = site.canopy.vine_variation = 0;
  const World world = make_world(site);
  // Leaves of the two vines at a panel's edge fall on either side at random: about 0.7 % of a panel, four of these.
  for (const RowAreas& row : world.areas())
    for (const double panel : row.panels.leaf_m2) EXPECT_NEAR(panel / 6.5, 1.5, 0.045);
}

TEST(World, PostsAloneHaveTheAreaOfTheirCylindersSplitBetweenPanels) {
  const Site site = bare_site();
  const World world = make_world(site);
  ASSERT_EQ(world.posts().size(), 6U);
  const double strainer = post_area(0.12, 1.9), line = post_area(0.07, 1.8);
  for (const RowAreas& row : world.areas()) {
    ASSERT_EQ(row.panels.wood_m2.size(), 2U);
    for (const double panel : row.panels.wood_m2) EXPECT_NEAR(panel, strainer + 0.5 * line, 1e-4);
    EXPECT_NEAR(row.metres.wood_m2.front(), strainer, 1e-4);
    EXPECT_NEAR(row.metres.wood_m2[12], 0.5 * line, 1e-4);  // the post stands at 6.5 m, between intervals 12 and 13
    EXPECT_NEAR(row.metres.wood_m2[13], 0.5 * line, 1e-4);
    EXPECT_EQ(row.metres.wood_m2[5], 0);
  }
}

TEST(World, WiresHaveTheAreaOfTheirCylinders) {
  Site site = bare_site();
  site.structure.wire_heights_m = {0.2, 1.0, 1.5};  // the lowest does not count
  const double posts = post_area(0.12, 1.9) + 0.5 * post_area(0.07, 1.8);
  const World world = make_world(site);
  const double wires = 2 * 0.5 * std::numbers::pi * 0.003 * 6.5;
  for (const double panel : world.areas()[0].panels.wood_m2) EXPECT_NEAR(panel - posts, wires, 2e-3 * wires + 1e-4);
}

TEST(World, MissingVinesCarryNothing) {
  Site site = small_site();
  site.rows.missing_fraction = 0.5;
  const World world = make_world(site);
  double planted = 0;
  for (const Vine& vine : world.vines()) {
    if (vine.missing) {
      EXPECT_EQ(vine.leaf_area_m2, 0);
    }
    planted += vine.missing ? 0 : 1;
  }
  ASSERT_GT(planted, 0);
  ASSERT_LT(planted, static_cast<double>(world.vines().size()));
  double total = 0;
  for (const RowAreas& row : world.areas()) total += sum(row.panels.leaf_m2);
  EXPECT_NEAR(total, 1.5 * 26 * planted / static_cast<double>(world.vines().size()), 1e-4 * total);
}

TEST(World, DatesShareEverythingButTheLeavesAndTheirLeavesAreNested) {
  Site site = small_site();
  site.canopy.leaf_area_m2_per_m = 3;
  site.dates.resize(3, site.dates[0]);
  site.dates[0].leaf_fraction = 0, site.dates[1].leaf_fraction = 0.4, site.dates[2].leaf_fraction = 1;
  site.dates[1].name = "b", site.dates[2].name = "c";
  const World none = make_world(site, 0), some = make_world(site, 1), all = make_world(site, 2);
  EXPECT_EQ(none.leaf_count(), 0U);
  const double count = static_cast<double>(all.leaf_count());
  EXPECT_NEAR(static_cast<double>(some.leaf_count()), 0.4 * count, 5 * std::sqrt(0.24 * count));
  for (std::size_t row = 0; row < 2; ++row) {
    EXPECT_EQ(none.areas()[row].metres.wood_m2, all.areas()[row].metres.wood_m2);
    for (std::size_t i = 0; i < some.areas()[row].metres.leaf_m2.size(); ++i)
      EXPECT_LE(some.areas()[row].metres.leaf_m2[i], all.areas()[row].metres.leaf_m2[i] + 1e-12);
  }
  for (std::size_t i = 0; i < all.posts().size(); ++i) EXPECT_EQ(none.posts()[i].position, all.posts()[i].position);
  // A ray that meets a leaf early in the season is stopped no later once the canopy is full; without leaves in its way
  // it ends at the same place.
  int leaves_hit = 0;
  for (int i = 0; i < 2000; ++i) {
    CounterRandom random(1, Stream::experiment, static_cast<std::uint64_t>(i));
    const Eigen::Vector3d from(random.uniform(-4, 4), random.uniform(-6, 6), 2.2);
    const Eigen::Vector3d direction = Eigen::Vector3d(random.normal(), random.normal(), -0.4).normalized();
    const auto a = none.cast(from, direction, 40), b = some.cast(from, direction, 40),
               c = all.cast(from, direction, 40);
    ASSERT_TRUE(a && b && c);
    EXPECT_LE(c->range_m, b->range_m);
    EXPECT_LE(b->range_m, a->range_m);
    if (c->material == Material::leaf) {
      ++leaves_hit;
    } else {
      EXPECT_EQ(c->range_m, a->range_m);
    }
  }
  EXPECT_GT(leaves_hit, 100);
}

TEST(World, RaysEndWhereThePlaneOfTheGroundIs) {
  Site site = bare_site();
  site.terrain.slope_percent = 6;
  site.terrain.slope_azimuth_deg = 120;
  const World world = make_world(site);
  const double azimuth = 120 * std::numbers::pi / 180;
  const Eigen::Vector3d normal(-0.06 * std::sin(azimuth), -0.06 * std::cos(azimuth), 1);  // normal · p = 0 on the plane
  int checked = 0;
  for (int i = 0; i < 500; ++i) {
    CounterRandom random(2, Stream::experiment, static_cast<std::uint64_t>(i));
    const Eigen::Vector3d from(random.uniform(-3, 3), random.uniform(-3, 3), 2);
    const Eigen::Vector3d direction = Eigen::Vector3d(random.normal(), random.normal(), -0.7).normalized();
    const auto hit = world.cast(from, direction, 40);
    ASSERT_TRUE(hit);
    if (hit->material != Material::ground) continue;
    const double expected = -normal.dot(from) / normal.dot(direction);
    EXPECT_NEAR(hit->range_m, expected, 1e-4 * expected);
    EXPECT_NEAR(hit->cos_incidence, std::abs(normal.normalized().dot(direction)), 1e-4);
    ++checked;
  }
  EXPECT_GT(checked, 400);
}

TEST(World, GroundHitsLieOnTheTrueGround) {
  const World world = make_world(small_site());
  int checked = 0;
  for (int i = 0; i < 3000; ++i) {
    CounterRandom random(3, Stream::experiment, static_cast<std::uint64_t>(i));
    const Eigen::Vector3d from(random.uniform(-4, 4), random.uniform(-6, 6), 2.2);
    const Eigen::Vector3d direction = Eigen::Vector3d(random.normal(), random.normal(), -0.8).normalized();
    const auto hit = world.cast(from, direction, 40);
    if (!hit || hit->material != Material::ground) continue;
    const Eigen::Vector3d end = from + hit->range_m * direction;
    EXPECT_NEAR(end.z(), world.terrain().height(end.head<2>()), 1e-4);
    ++checked;
  }
  EXPECT_GT(checked, 500);
}

TEST(World, TheResultDoesNotDependOnTheNumberOfThreads) {
  Progress progress;
  const World one = take(build_world(small_site(), 0, 1, progress)),
              three = take(build_world(small_site(), 0, 3, progress));
  EXPECT_EQ(one.triangle_count(), three.triangle_count());
  for (std::size_t row = 0; row < 2; ++row) {
    EXPECT_EQ(one.areas()[row].metres.leaf_m2, three.areas()[row].metres.leaf_m2);
    EXPECT_EQ(one.areas()[row].metres.wood_m2, three.areas()[row].metres.wood_m2);
  }
}

TEST(World, ADateThatDoesNotExistIsAUsageError) {
  Progress progress;
  const auto world = build_world(small_site(), 1, 1, progress);
  ASSERT_FALSE(world);
  EXPECT_EQ(world.error().code, ErrorCode::usage);
}

TEST(World, StopsWhenAskedTo) {
  class Stop : public Progress {
    bool cancelled() const override { return true; }
  } stop;
  const auto world = build_world(small_site(), 0, 1, stop);
  ASSERT_FALSE(world);
  EXPECT_EQ(world.error().code, ErrorCode::interrupted);
}

}  // namespace
}  // namespace rayfield::sim
