#include "rayfield/formats/draw_zones.h"

#include <gtest/gtest.h>
#include <ogr_api.h>

#include <cmath>
#include <memory>

#include "formats/zones/zone_table.h"
#include "tests/formats/zones/zone_support.h"

namespace rayfield::formats {
namespace {

using testing::drawn_map;
using testing::hilly_surface;
using testing::kRowLength_m;
using testing::kRows;
using testing::kSpacing_m;

using Geometry = std::unique_ptr<OGRGeometry>;

std::vector<Geometry> geometries(const ZoneMap& map) {
  std::vector<Geometry> all;
  for (const VectorFeature& feature : zone_table(map, {}).features) all.emplace_back(feature.geometry->clone());
  return all;
}

double area_of(const OGRGeometry& geometry) {
  return wkbFlatten(geometry.getGeometryType()) == wkbPolygon ? geometry.toPolygon()->get_Area()
                                                              : geometry.toGeometryCollection()->get_Area();
}

TEST(DrawZones, CoverTheBlockWithoutOverlapsAndSlivers) {
  const double min_zone_m2 = 60;
  const ZoneMap map = drawn_map(min_zone_m2);
  ASSERT_EQ(map.zones.size(), 3U);
  double sum = 0;
  for (const ManagementZone& zone : map.zones) sum += zone.area_m2;
  const double block = kRows * kSpacing_m * kRowLength_m;
  EXPECT_NEAR(sum, block, 0.005 * block);
  const std::vector<Geometry> zones = geometries(map);
  for (std::size_t i = 0; i < zones.size(); ++i) {
    EXPECT_TRUE(zones[i]->IsValid());
    for (std::size_t k = i + 1; k < zones.size(); ++k) {
      const Geometry shared(zones[i]->Intersection(zones[k].get()));
      ASSERT_NE(shared, nullptr);
      const double area = shared->getDimension() == 2 ? OGR_G_Area(OGRGeometry::ToHandle(shared.get())) : 0;
      EXPECT_LT(area, 1e-6) << i << " and " << k;
    }
    for (const OGRPolygon* part : *zones[i]->toMultiPolygon()) EXPECT_GE(part->get_Area(), min_zone_m2);
  }
  // Nothing between the zones is left uncovered.
  OGRMultiPolygon all;
  for (const Geometry& zone : zones)
    for (const OGRPolygon* part : *zone->toMultiPolygon()) all.addGeometry(part);
  const Geometry joined(all.UnionCascaded());
  EXPECT_NEAR(area_of(*joined), sum, 1e-6);
  ASSERT_EQ(wkbFlatten(joined->getGeometryType()), wkbPolygon);
  EXPECT_EQ(joined->toPolygon()->getNumInteriorRings(), 0);
}

TEST(DrawZones, EachPlaceLiesInTheZoneOfItsValue) {
  const ZoneMap map = drawn_map(0);
  const Grid2<double> surface = hilly_surface();
  const std::vector<Geometry> zones = geometries(map);
  int checked = 0;
  for (int row = 0; row < kRows; ++row)
    for (double x = 1; x < kRowLength_m; x += 2) {
      const OGRPoint place(testing::kCorner.x() + x, testing::kCorner.y() + kSpacing_m * (row + 0.5));
      const double value = testing::hill(x, kSpacing_m * (row + 0.5));
      for (std::size_t i = 0; i < zones.size(); ++i) {
        const ManagementZone& zone = map.zones[i];
        // Borders may be moved by a fifth of a cell, where the surface changes by at most 0.05.
        if (std::abs(value - zone.low) < 0.05 || std::abs(value - zone.high) < 0.05) continue;
        ++checked;
        EXPECT_EQ(zones[i]->Contains(&place) != 0, value > zone.low && value < zone.high) << x << " in row " << row;
      }
    }
  EXPECT_GT(checked, 200);
}

TEST(DrawZones, SmallPartsJoinTheirNeighbour) {
  const ZoneMap fine = drawn_map(0), coarse = drawn_map(1e9);
  EXPECT_GE(fine.zones.size(), 3U);
  ASSERT_EQ(coarse.zones.size(), 1U) << "no zone is that large, so that one takes all";
  EXPECT_NEAR(coarse.zones[0].area_m2, kRows * kSpacing_m * kRowLength_m, 0.005 * kRows * kSpacing_m * kRowLength_m);
}

TEST(DrawZones, GapsBetweenRowsOfVaryingDistanceAreClosed) {
  std::vector<std::vector<Eigen::Vector2d>> bands = testing::bands();
  for (std::size_t i = 1; i < bands.size(); ++i)
    for (Eigen::Vector2d& p : bands[i]) p.y() += 0.2 * static_cast<double>(i);
  const auto zones = draw_zones(hilly_surface(), std::vector<double>{}, bands, 0);
  ASSERT_TRUE(zones) << zones.error().line();
  ASSERT_EQ(zones->size(), 1U);
  EXPECT_EQ((*zones)[0].parts.size(), 1U);
  EXPECT_TRUE((*zones)[0].parts[0].holes.empty());
}

TEST(DrawZones, ABlockWithoutRowsIsRefused) {
  const auto zones = draw_zones(hilly_surface(), std::vector<double>{2.0}, {}, 0);
  ASSERT_FALSE(zones);
  EXPECT_EQ(zones.error().code, ErrorCode::bad_input);
}

}  // namespace
}  // namespace rayfield::formats
