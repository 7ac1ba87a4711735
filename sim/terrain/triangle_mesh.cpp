#include "sim/terrain/triangle_mesh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace rayfield::sim {

void TriangleMesh::add_triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const std::uint32_t ia = add_vertex(a), ib = add_vertex(b), ic = add_vertex(c);
  add_triangle(ia, ib, ic);
}

void TriangleMesh::add_quad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                            const Eigen::Vector3d& d) {
  const std::uint32_t ia = add_vertex(a), ib = add_vertex(b), ic = add_vertex(c), id = add_vertex(d);
  add_triangle(ia, ib, ic);
  add_triangle(ia, ic, id);
}

void add_limb(TriangleMesh& mesh, const Limb& limb) {
  const Eigen::Vector3d axis = limb.to - limb.from;
  if (axis.squaredNorm() == 0) return;
  const Eigen::Vector3d w = axis.normalized();
  const Eigen::Vector3d helper = std::abs(w.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d u = helper.cross(w).normalized(), v = w.cross(u);
  const double step = 2 * std::numbers::pi / limb.sides;
  // Circumradius of the polygon whose perimeter is that of the circle of diameter 1.
  const double unit_radius = (std::numbers::pi / limb.sides) / (2 * std::sin(std::numbers::pi / limb.sides));
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < limb.sides; ++i) {
    const Eigen::Vector3d spoke = unit_radius * (std::cos(i * step) * u + std::sin(i * step) * v);
    mesh.add_vertex(limb.from + limb.from_diameter_m * spoke);
    mesh.add_vertex(limb.to + limb.to_diameter_m * spoke);
  }
  const auto count = static_cast<std::uint32_t>(limb.sides);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % count);
    mesh.add_triangle(a, b, b + 1);
    mesh.add_triangle(a, b + 1, a + 1);
  }
  if (!limb.cap_end) return;
  for (std::uint32_t i = 1; i + 1 < count; ++i)
    mesh.add_triangle(first + 1, first + 2 * i + 1, first + 2 * (i + 1) + 1);
}

}  // namespace rayfield::sim
