#include "sim/vines/leaf_shapes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace rayfield::sim {
namespace {

constexpr double kLeaf_m2 = 0.0043;

struct Outlined {
  double area_m2 = 0, farthest_m = 0, nearest_m = 1;  ///< distances of the outline's corners from the centre
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< of gravity
};

Outlined drawn(LeafShape shape) {
  const Eigen::Vector3d at(2, -3, 1.5), u = Eigen::Vector3d(1, 2, -1).normalized();
  const Eigen::Vector3d v = u.unitOrthogonal();
  TriangleMesh mesh;
  add_leaf(mesh, LeafShape::rhombus, {0, 0, 0}, u, v, 0.01);  // what is there before stays
  const std::size_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
  add_leaf(mesh, shape, at, u, v, kLeaf_m2);
  EXPECT_EQ(mesh.vertices.size() - vertices, vertices_of(shape));
  Outlined out;
  for (std::size_t i = triangles; i < mesh.triangles.size(); ++i) {
    std::array<Eigen::Vector3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.vertices[mesh.triangles[i][k]].cast<double>();
    const Eigen::Vector3d twice = (p[1] - p[0]).cross(p[2] - p[0]);
    EXPECT_NEAR(std::abs(twice.normalized().dot(u.cross(v))), 1, 1e-4);
    out.area_m2 += 0.5 * twice.norm(), out.centre += 0.5 * twice.norm() * (p[0] + p[1] + p[2]) / 3;
  }
  out.centre = out.centre / out.area_m2 - at;
  for (std::size_t i = vertices; i < mesh.vertices.size(); ++i) {
    const double distance = (mesh.vertices[i].cast<double>() - at).norm();
    if (distance < 1e-6) continue;  // the middle of a fan
    out.farthest_m = std::max(out.farthest_m, distance), out.nearest_m = std::min(out.nearest_m, distance);
  }
  return out;
}

TEST(LeafShapes, HaveTheAreaAskedForAboutTheirCentre) {
  for (const LeafShape shape : {LeafShape::rhombus, LeafShape::triangle, LeafShape::lobed}) {
    const Outlined leaf = drawn(shape);
    EXPECT_NEAR(leaf.area_m2, kLeaf_m2, 1e-5 * kLeaf_m2 + 1e-8);
    EXPECT_LT(leaf.centre.norm(), 1e-6);
  }
}

// An equilateral triangle of side s: area √3/4·s², corners s/√3 from its centre. A square of side s: s/√2.
TEST(LeafShapes, ReachAsFarAsTheirOutlineSays) {
  const double side = std::sqrt(4 * kLeaf_m2 / std::sqrt(3.0));
  EXPECT_NEAR(drawn(LeafShape::triangle).farthest_m, side / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(drawn(LeafShape::triangle).nearest_m, side / std::sqrt(3.0), 1e-6);
  const Outlined rhombus = drawn(LeafShape::rhombus), lobed = drawn(LeafShape::lobed);
  EXPECT_NEAR(std::sqrt(rhombus.farthest_m * rhombus.nearest_m), std::sqrt(kLeaf_m2 / 2), 1e-6);
  EXPECT_NEAR(lobed.nearest_m / lobed.farthest_m, 0.55, 1e-4);
}

}  // namespace
}  // namespace rayfield::sim
