#include "libdensity/rows/canopy_map.h"

#include <gtest/gtest.h>

#include "tests/libdensity/scene.h"

namespace rayfield::density {
namespace {

using testing::exact_ground;
using testing::Scene;

TEST(CanopyMap, KeepsLayersApart) {
  const GroundModel ground = exact_ground([](double, double) { return 100.0; });
  Scene scene(44);
  scene.add_point({500001.05, 6100001.05, 100.3});
  scene.add_point({500001.05, 6100001.05, 101.2});
  scene.add_point({500001.05, 6100001.05, 101.3});
  scene.add_point({500001.05, 6100001.05, 106.0});
  scene.add_point({500001.05, 6100001.05, 100.05});  // ground: in no layer
  CanopyAccumulator sum({{20000, 244000}, testing::kTile}, ground, {});
  sum.add(testing::hits_of(scene.tiles().at({20000, 244000})));
  CanopyMap map(testing::kTile);
  map.set({20000, 244000}, sum.finish());
  const Eigen::Vector2d p(500001.05, 6100001.05);
  EXPECT_EQ(map.hits(CanopyLayer::stem, p), 1);
  EXPECT_EQ(map.hits(CanopyLayer::canopy, p), 2);
  EXPECT_EQ(map.hits(CanopyLayer::tall, p), 1);
  EXPECT_EQ(map.hits(CanopyLayer::canopy, p + Eigen::Vector2d(0.1, 0)), 0);
  EXPECT_EQ(map.hits(CanopyLayer::canopy, {400000, 6100000}), 0);
}

}  // namespace
}  // namespace rayfield::density
