#include "sim/vines/wind.h"

#include <gtest/gtest.h>

#include "sim/vines/leaf_shapes.h"
#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

// One leaf every metre of a straight row along north, and a second one a centimetre from each.
TriangleMesh pairs_of_leaves(const BlockGeometry& block, int pairs) {
  TriangleMesh mesh;
  for (int i = 0; i < pairs; ++i)
    for (const double beside : {0.31, 0.32}) {
      const Eigen::Vector2d p = block.row_point(0, i + beside);
      add_leaf(mesh, LeafShape::rhombus, {p.x(), p.y(), 1.5}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
               0.005);
    }
  return mesh;
}

TEST(Wind, LeavesMoveByTheStatedRootMeanSquareAndShootsTogether) {
  Site site = small_site();
  site.rows.length_m = 400;
  site.wind = {0.04, 0.25};
  const BlockGeometry block(site.rows);
  const TriangleMesh mesh = pairs_of_leaves(block, 400);
  const auto steps = blown_leaves(site, 9, block, 0, mesh);
  ASSERT_GT(steps.size(), 3U);
  EXPECT_EQ(steps.front(), steps.back());
  // Between two steps a leaf moves on a line: the mean square of a + s(b − a) is (a² + ab + b²) / 3.
  Eigen::Array3d square = Eigen::Array3d::Zero();
  double apart = 0, count = 0;
  for (std::size_t k = 0; k + 1 < steps.size(); ++k)
    for (std::size_t v = 0; v < mesh.vertices.size(); v += 8) {
      const Eigen::Array3d a = (steps[k][v] - mesh.vertices[v]).cast<double>().array(),
                           b = (steps[k + 1][v] - mesh.vertices[v]).cast<double>().array();
      square += (a * a + a * b + b * b) / 3, ++count;
      const Eigen::Array3d neighbour = (steps[k][v + 4] - mesh.vertices[v + 4]).cast<double>().array();
      apart = std::max(apart, (a - neighbour).abs().maxCoeff());
    }
  // 6400 independent displacements: a standard error of 1 % of the mean square.
  EXPECT_NEAR(square.x() / count, 0.04 * 0.04, 0.05 * 0.04 * 0.04);
  EXPECT_NEAR(square.y() / count, 0.04 * 0.04, 0.05 * 0.04 * 0.04);
  EXPECT_NEAR(square.z() / count, 0.04 * 0.04 / 9, 0.05 * 0.04 * 0.04 / 9);
  EXPECT_LT(apart, 1e-4);
}

TEST(Wind, TheSceneChangesWithTimeAndComesBackAfterACycle) {
  Site site = small_site();
  site.wind.rms_m = 0.05;
  const World windy = make_world(site);
  site.wind.rms_m = 0;
  const World calm = make_world(site);
  int moved = 0, moved_in_calm = 0, returned = 0, leaves = 0;
  for (int i = 0; i < 400; ++i) {
    const Post& post = windy.posts().front();
    const Eigen::Vector3d from(post.position.x() - 3, post.position.y() + 0.02 * i, post.ground_m + 1.4);
    const Eigen::Vector3d direction = Eigen::Vector3d(1, 0.3, 0).normalized();
    const auto a = windy.cast(from, direction, 20, 3), b = windy.cast(from, direction, 20, 41),
               c = windy.cast(from, direction, 20, 123);
    if (!a || a->material != Material::leaf) continue;
    ++leaves;
    moved += !b || std::abs(a->range_m - b->range_m) > 1e-3 ? 1 : 0;
    returned += c && std::abs(a->range_m - c->range_m) < 1e-4 ? 1 : 0;
    const auto d = calm.cast(from, direction, 20, 3), e = calm.cast(from, direction, 20, 41);
    moved_in_calm += d.has_value() != e.has_value() || (d && d->range_m != e->range_m) ? 1 : 0;
  }
  ASSERT_GT(leaves, 50);
  EXPECT_GT(moved, leaves / 2);
  EXPECT_EQ(moved_in_calm, 0);
  EXPECT_GT(returned, 0.95 * leaves);
}

}  // namespace
}  // namespace rayfield::sim
