#include "rayfield/sim/truth.h"

#include <cmath>
#include <numbers>

#include "rayfield/core/map_frame.h"
#include "sim/terrain/terrain.h"
#include "tests/sim/true_values.h"

namespace rayfield::sim {
namespace {

class TruthTest : public TrueValues {};

TEST_F(TruthTest, HoldsEveryRowPanelMetreAndPost) {
  EXPECT_EQ(result.rows.size(), 2U);
  EXPECT_EQ(result.panels.size(), 4U);
  EXPECT_EQ(result.metres.size(), 52U);
  EXPECT_EQ(result.posts.size(), 6U);
  double panels = 0, metres = 0;
  for (const Truth::Panel& panel : result.panels) panels += panel.leaf_area_m2 + panel.wood_area_m2;
  for (const Truth::Metre& metre : result.metres) metres += 0.5 * (metre.leaf_area_per_m + metre.wood_area_per_m);
  EXPECT_NEAR(panels, metres, 1e-9);
  EXPECT_NEAR(panels, result.leaf_area_m2 + result.wood_area_m2, 1e-9);
}

TEST_F(TruthTest, PostsStandAtPanelEndsOnTheGround) {
  for (const Truth::Panel& panel : result.panels) {
    const Post& post = result.posts[static_cast<std::size_t>(panel.row * 3 + panel.panel)];
    EXPECT_NEAR((post.position - panel.from).norm(), 0, 1e-9);
    EXPECT_NEAR(post.ground_m, world.terrain().height(post.position), 1e-9);
  }
}

TEST_F(TruthTest, MapTrajectoryIsTheLocalOneThroughTheProjectionWithItsConvergence) {
  const Site& site = result.site;
  const MapFrame frame = take(MapFrame::create("EPSG:7854"));
  const TangentPlane plane({site.latitude_deg, site.longitude_deg, site.height_m});
  for (std::size_t i = 0; i < result.trajectory.size(); i += 500) {
    const Rigid3 &local = result.trajectory[i].map_from_body, &map = result.trajectory_in_map[i].map_from_body;
    const Eigen::Vector3d expected = frame.map_from_geodetic(plane.geodetic_from_enu(local.translation));
    EXPECT_NEAR((map.translation - expected).norm(), 0, 1e-4);
    // Grid north lies the convergence clockwise of true north: azimuths on the grid are smaller by it.
    const Eigen::Vector3d a = local.rotation * Eigen::Vector3d::UnitX(), b = map.rotation * Eigen::Vector3d::UnitX();
    const double turn = std::remainder(std::atan2(b.x(), b.y()) - std::atan2(a.x(), a.y()), 2 * std::numbers::pi);
    EXPECT_NEAR(turn, -frame.convergence_rad(map.translation), 1e-6);
  }
}

}  // namespace
}  // namespace rayfield::sim
