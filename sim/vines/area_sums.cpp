#include "sim/vines/area_sums.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rayfield::sim {
namespace {

struct Corner {
  Eigen::Vector3d p;
  double chainage, height;
};
using Polygon = std::vector<Corner>;

double area(const Polygon& polygon) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += (polygon[i - 1].p - polygon[0].p).cross(polygon[i].p - polygon[0].p);
  return 0.5 * sum.norm();
}

// The part of a convex polygon where sign·(value − limit) ≥ 0; values are linear along its edges.
Polygon clip(const Polygon& polygon, double Corner::*value, double limit, double sign) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner& a = polygon[i];
    const Corner& b = polygon[(i + 1) % polygon.size()];
    const double fa = sign * (a.*value - limit), fb = sign * (b.*value - limit);
    if (fa >= 0) kept.push_back(a);
    if ((fa < 0) == (fb < 0)) continue;
    const double t = fa / (fa - fb);
    kept.push_back(
        {a.p + t * (b.p - a.p), a.chainage + t * (b.chainage - a.chainage), a.height + t * (b.height - a.height)});
  }
  return kept;
}

// Adds the polygon's area to the intervals between `edges`.
void distribute(const Polygon& polygon, double factor, const std::vector<double>& edges, std::vector<double>& sums) {
  if (polygon.size() < 3) return;
  const auto [low, high] = std::minmax_element(
      polygon.begin(), polygon.end(), [](const Corner& a, const Corner& b) { return a.chainage < b.chainage; });
  const auto interval = [&](double chainage) {
    const auto inner = std::upper_bound(edges.begin() + 1, edges.end() - 1, chainage);
    return static_cast<std::size_t>(inner - edges.begin() - 1);
  };
  const std::size_t first = interval(low->chainage), last = interval(high->chainage);
  Polygon rest = polygon;
  for (std::size_t i = first; i < last; ++i) {
    sums[i] += factor * area(clip(rest, &Corner::chainage, edges[i + 1], -1));
    rest = clip(rest, &Corner::chainage, edges[i + 1], 1);
  }
  sums[last] += factor * area(rest);
}

IntervalAreas make_intervals(double length, double step) {
  IntervalAreas intervals;
  const int count = std::max(1, static_cast<int>(std::ceil(length / step - 1e-6)));
  for (int i = 0; i < count; ++i) intervals.edges_m.push_back(i * step);
  intervals.edges_m.push_back(length);
  intervals.leaf_m2.assign(static_cast<std::size_t>(count), 0.0);
  intervals.wood_m2 = intervals.leaf_m2;
  return intervals;
}

Polygon triangle_in_row(const BlockGeometry& block, int row, const TriangleMesh& mesh, std::size_t index) {
  Polygon polygon;
  for (const std::uint32_t vertex : mesh.triangles[index]) {
    const Eigen::Vector3d p = mesh.vertices[vertex].cast<double>();
    polygon.push_back({p, block.row_position(row, p.head<2>()).chainage, 0});
  }
  return polygon;
}

}  // namespace

AreaSums::AreaSums(const Site& site, const BlockGeometry& block, const Terrain& terrain)
    : block_(block), terrain_(terrain) {
  RowAreas row;
  row.panels = make_intervals(site.rows.length_m, site.rows.panel_length_m);
  row.metres = make_intervals(site.rows.length_m, kMetreStep);
  rows_.assign(static_cast<std::size_t>(site.rows.count), row);
}

void AreaSums::add_leaves(int row, const TriangleMesh& mesh, std::size_t first, std::size_t last) {
  RowAreas& sums = rows_[static_cast<std::size_t>(row)];
  for (std::size_t i = first; i < last; ++i) {
    const Polygon polygon = triangle_in_row(block_, row, mesh, i);
    distribute(polygon, 1, sums.panels.edges_m, sums.panels.leaf_m2);
    distribute(polygon, 1, sums.metres.edges_m, sums.metres.leaf_m2);
  }
}

void AreaSums::add_wood(int row, const TriangleMesh& mesh, std::size_t first, std::size_t last) {
  RowAreas& sums = rows_[static_cast<std::size_t>(row)];
  for (std::size_t i = first; i < last; ++i) {
    Polygon polygon = triangle_in_row(block_, row, mesh, i);
    for (Corner& corner : polygon) corner.height = corner.p.z() - terrain_.height(corner.p.head<2>());
    polygon = clip(polygon, &Corner::height, kWoodFromHeight, 1);
    distribute(polygon, 0.5, sums.panels.edges_m, sums.panels.wood_m2);
    distribute(polygon, 0.5, sums.metres.edges_m, sums.metres.wood_m2);
  }
}

}  // namespace rayfield::sim
