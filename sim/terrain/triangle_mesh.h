#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace rayfield::sim {

/// Triangles in local east-north-up metres, as the ray caster takes them.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  std::uint32_t add_vertex(const Eigen::Vector3d& p) {
    vertices.push_back(p.cast<float>());
    return static_cast<std::uint32_t>(vertices.size() - 1);
  }
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { triangles.push_back({a, b, c}); }
  /// A triangle of its own vertices.
  void add_triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);
  /// A plane quadrilateral of two triangles, corners in order.
  void add_quad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Eigen::Vector3d& d);
};

/// A cylinder or cone frustum as a prism whose sides have the perimeter of the circle: the same lateral surface and, by
/// Cauchy's formula, the same mean width.
struct Limb {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  double from_diameter_m = 0, to_diameter_m = 0;
  int sides = 8;
  bool cap_end = false;  ///< closes the far end
};
void add_limb(TriangleMesh& mesh, const Limb& limb);

}  // namespace rayfield::sim
