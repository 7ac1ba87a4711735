#include "sim/vines/leaf_shapes.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace rayfield::sim {
namespace {

constexpr double kElongation = 1.05;  // of a rhombus: its longer diagonal over that of a square
constexpr double kSinus = 0.55;       // of a lobed leaf: where its outline is nearest to the centre, over the tips
constexpr std::size_t kLobes = 5;

using Outline = std::vector<Eigen::Vector2d>;  // around the centre of gravity; its area is 1

Outline regular_star(std::size_t points, double inner) {
  Outline outline;
  const std::size_t corners = inner < 1 ? 2 * points : points;
  const double step = 2 * std::numbers::pi / static_cast<double>(corners);
  for (std::size_t i = 0; i < corners; ++i) {
    const double radius = inner < 1 && i % 2 == 1 ? inner : 1, turn = static_cast<double>(i) * step;
    outline.emplace_back(radius * std::cos(turn), radius * std::sin(turn));
  }
  // Triangles between the centre and neighbouring corners: each ½·r·r′·sin(step).
  const double area = 0.5 * static_cast<double>(corners) * (inner < 1 ? inner : 1) * std::sin(step);
  for (Eigen::Vector2d& corner : outline) corner /= std::sqrt(area);
  return outline;
}

Outline outline_of(LeafShape shape) {
  const double half = std::sqrt(0.5);
  switch (shape) {
    case LeafShape::rhombus:
      return {{-kElongation * half, 0}, {0, half / kElongation}, {kElongation * half, 0}, {0, -half / kElongation}};
    case LeafShape::triangle:
      return regular_star(3, 1);
    case LeafShape::lobed:
      return regular_star(kLobes, kSinus);
  }
  return {};
}

}  // namespace

void add_leaf(TriangleMesh& mesh, LeafShape shape, const Eigen::Vector3d& center, const Eigen::Vector3d& long_axis,
              const Eigen::Vector3d& short_axis, double leaf_size_m2) {
  const Outline outline = outline_of(shape);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size()),
             corners = static_cast<std::uint32_t>(outline.size());
  for (const Eigen::Vector2d& corner : outline)
    mesh.add_vertex(center + std::sqrt(leaf_size_m2) * (corner.x() * long_axis + corner.y() * short_axis));
  if (shape == LeafShape::lobed) {  // not convex: around the centre
    const std::uint32_t middle = mesh.add_vertex(center);
    for (std::uint32_t i = 0; i < corners; ++i) mesh.add_triangle(middle, first + i, first + (i + 1) % corners);
    return;
  }
  for (std::uint32_t i = 1; i + 1 < corners; ++i) mesh.add_triangle(first, first + i, first + i + 1);
}

std::size_t vertices_of(LeafShape shape) {
  switch (shape) {
    case LeafShape::rhombus:
      return 4;
    case LeafShape::triangle:
      return 3;
    case LeafShape::lobed:
      return 2 * kLobes + 1;
  }
  return 0;
}

}  // namespace rayfield::sim
