#include "libdensity/ground/ground.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "libdensity/ground/ground_cells.h"
#include "libdensity/ground/lower_hull.h"
#include "libdensity/tiles/rounding.h"
#include "rayfield/core/median.h"

namespace rayfield::density {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kWhat = "cannot estimate the ground";

// The hull's height at the points of a lattice, NaN outside of it. Lattice points stand at origin + i·cell.
Grid2<double> rasterise(const LowerHull& hull, const std::vector<Eigen::Vector3d>& points,
                        const Eigen::Vector2d& origin, double cell_m, int n) {
  Grid2<double> out(origin, cell_m, n, n, kNaN);
  const auto clamp_index = [n](double v) { return static_cast<int>(std::clamp(v, -1.0, static_cast<double>(n))); };
  for (const auto& triangle : hull.triangles) {
    const Eigen::Vector3d& a = points[static_cast<std::size_t>(triangle[0])];
    const Eigen::Vector3d& b = points[static_cast<std::size_t>(triangle[1])];
    const Eigen::Vector3d& c = points[static_cast<std::size_t>(triangle[2])];
    const Eigen::Vector2d ab = (b - a).head<2>(), ac = (c - a).head<2>();
    const double area = ab.x() * ac.y() - ab.y() * ac.x();
    if (area < 1e-12) continue;
    const Eigen::Vector2d low = (a.head<2>().cwiseMin(b.head<2>()).cwiseMin(c.head<2>()) - origin) / cell_m;
    const Eigen::Vector2d high = (a.head<2>().cwiseMax(b.head<2>()).cwiseMax(c.head<2>()) - origin) / cell_m;
    const int x0 = std::max(0, clamp_index(std::ceil(low.x() - 1e-9)));
    const int x1 = std::min(n - 1, clamp_index(std::floor(high.x() + 1e-9)));
    const int y0 = std::max(0, clamp_index(std::ceil(low.y() - 1e-9)));
    const int y1 = std::min(n - 1, clamp_index(std::floor(high.y() + 1e-9)));
    for (int iy = y0; iy <= y1; ++iy)
      for (int ix = x0; ix <= x1; ++ix) {
        const Eigen::Vector2d p = origin + cell_m * Eigen::Vector2d(ix, iy) - a.head<2>();
        const double v = (p.x() * ac.y() - p.y() * ac.x()) / area, w = (ab.x() * p.y() - ab.y() * p.x()) / area;
        if (v < -1e-9 || w < -1e-9 || v + w > 1 + 1e-9) continue;
        out.at(ix, iy) = a.z() + v * (b.z() - a.z()) + w * (c.z() - a.z());
      }
  }
  return out;
}

// Everything that the heights of nodes are computed from, on the lattice of tile and halo.
struct Surface {
  Grid2<double> half;  // hull at half-cell spacing: cell (x,y) has its centre at (2x+1, 2y+1), its corner at (2x, 2y)
  Grid2<CellMode> modes;  // per cell
  const Grid2<double>* lows = nullptr;
};

bool near_candidate(const Grid2<double>& lows, int cx, int cy, int reach) {
  for (int ring = 0; ring <= reach; ++ring)
    for (int y = cy - ring - 1; y <= cy + ring; ++y)
      for (int x = cx - ring - 1; x <= cx + ring; ++x)
        if (lows.contains(x, y) && std::isfinite(lows.at(x, y)) && std::hypot(x + 0.5 - cx, y + 0.5 - cy) <= reach)
          return true;
  return false;
}

// Robust local plane through the cell modes around a node, gaussian weights, Tukey re-weighting: its value at the node.
double plane_at_node(const Surface& s, int cx, int cy, double sigma_cells, double cell_m) {
  constexpr double kTukey = 0.08;  // m
  const int reach = ceil_int(3 * sigma_cells);
  double level = kNaN;
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();
  const double reference = s.half.at(2 * cx, 2 * cy);
  for (int iteration = 0; iteration < 4; ++iteration) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (int y = cy - reach; y < cy + reach; ++y)
      for (int x = cx - reach; x < cx + reach; ++x) {
        if (!s.modes.contains(x, y) || s.modes.at(x, y).weight <= 0) continue;
        const Eigen::Vector2d d((x + 0.5 - cx), (y + 0.5 - cy));
        const Eigen::Vector3d row(1, d.x() * cell_m, d.y() * cell_m);
        const double z = s.modes.at(x, y).height_m - reference;
        double w = s.modes.at(x, y).weight * std::exp(-0.5 * d.squaredNorm() / (sigma_cells * sigma_cells));
        if (iteration > 0) {
          const double r = (z - row.dot(plane)) / kTukey;
          w *= std::abs(r) < 1 ? (1 - r * r) * (1 - r * r) : 0;
        }
        normal += w * row * row.transpose();
        right += w * z * row;
      }
    if (normal(0, 0) < 3) return kNaN;
    // A weak pull towards level ground keeps the slope bounded where the cells stand in a line.
    const double pull = 1e-3 * normal(0, 0) * cell_m * cell_m;
    normal(1, 1) += pull, normal(2, 2) += pull;
    plane = normal.ldlt().solve(right);
    level = plane(0);
  }
  return reference + level;
}

// Mean of (mode − hull) over a wider neighbourhood, added to the hull: for nodes with too few hits around them.
double lifted_hull(const Surface& s, int cx, int cy, int reach) {
  double sum = 0, weight = 0;
  for (int y = cy - reach; y < cy + reach; ++y)
    for (int x = cx - reach; x < cx + reach; ++x) {
      if (!s.modes.contains(x, y) || s.modes.at(x, y).weight <= 0) continue;
      const double distance = std::hypot(x + 0.5 - cx, y + 0.5 - cy);
      const double w = s.modes.at(x, y).weight / (1 + distance * distance);
      sum += w * (s.modes.at(x, y).height_m - s.half.at(2 * x + 1, 2 * y + 1));
      weight += w;
    }
  return s.half.at(2 * cx, 2 * cy) + (weight > 0 ? sum / weight : 0.0);
}

Surface make_surface(const GroundCells& cells, const Grid2<double>& lows, const LowerHull& hull,
                     const std::vector<Eigen::Vector3d>& points, const GroundOptions& options) {
  Surface s;
  s.lows = &lows;
  s.half = rasterise(hull, points, cells.corner(), 0.5 * cells.cell_m(), 2 * cells.size() + 1);
  s.modes = Grid2<CellMode>(cells.corner(), cells.cell_m(), cells.size(), cells.size());
  // Only cells within two metres of the tile can reach one of its nodes.
  const int margin = std::max(0, cells.halo() - ceil_int(2.0 / cells.cell_m()));
  for (int y = margin; y < cells.size() - margin; ++y)
    for (int x = margin; x < cells.size() - margin; ++x) {
      const double base = s.half.at(2 * x + 1, 2 * y + 1);
      if (std::isfinite(base)) s.modes.at(x, y) = ground_mode(cells.bins(x, y), cells.bin_m(), base, options);
    }
  return s;
}

double median_lift(const Surface& s, int halo, int n) {
  std::vector<double> lifts;
  for (int y = halo; y < halo + n; ++y)
    for (int x = halo; x < halo + n; ++x)
      if (s.modes.at(x, y).weight > 0) lifts.push_back(s.modes.at(x, y).height_m - s.half.at(2 * x + 1, 2 * y + 1));
  return median_of(std::move(lifts));
}

void fill_nodes(const Surface& s, int halo, const GroundOptions& options, GroundTile& out) {
  const double cell_m = out.nodes.cell_m;
  const int gap_cells = floor_int(options.max_gap_m / cell_m);
  const int wide_cells = ceil_int(1.5 / cell_m);
  for (int iy = 0; iy < out.nodes.ny; ++iy)
    for (int ix = 0; ix < out.nodes.nx; ++ix) {
      const int cx = ix + halo, cy = iy + halo;
      if (!std::isfinite(s.half.at(2 * cx, 2 * cy)) || !near_candidate(*s.lows, cx, cy, gap_cells)) continue;
      double z = plane_at_node(s, cx, cy, options.fit_radius_m / cell_m, cell_m);
      if (!std::isfinite(z)) z = lifted_hull(s, cx, cy, wide_cells);
      out.nodes.at(ix, iy) = static_cast<float>(z);
      ++out.known_nodes;
    }
}

}  // namespace

Result<GroundTile> estimate_ground(tile::TileIndex index, std::span<const TileSurvey* const> surveys,
                                   const GroundOptions& options) {
  RAYFIELD_CHECK(options.validate());
  if (surveys.empty()) return fail(ErrorCode::usage, kWhat, "tile", "no survey was given");
  const TileSurvey& reference = *surveys.front();
  for (const TileSurvey* survey : surveys)
    if (survey->cells != reference.cells || survey->tile_size_m != reference.tile_size_m ||
        survey->bin_m != reference.bin_m)
      return fail(ErrorCode::usage, kWhat, "tile", "the surveys have different cell sizes",
                  "survey all tiles with the same options");

  const double cell_m = reference.cell_m();
  const GroundCells cells(index, surveys, ceil_int(options.halo_m / cell_m));
  GroundTile out;
  out.nodes = Grid2<float>(Eigen::Vector2d(index.ix, index.iy) * reference.tile_size_m, cell_m, reference.cells + 1,
                           reference.cells + 1, std::numeric_limits<float>::quiet_NaN());
  out.median_lift_m = kNaN;
  const Grid2<double> lows = supported_lows(cells, options);
  std::vector<Eigen::Vector3d> points;
  for (int iy = 0; iy < lows.ny; ++iy)
    for (int ix = 0; ix < lows.nx; ++ix)
      if (std::isfinite(lows.at(ix, iy))) {
        const Eigen::Vector2d p = lows.center(ix, iy);
        points.emplace_back(p.x(), p.y(), lows.at(ix, iy));
      }
  out.candidates = static_cast<int>(points.size());

  const Result<LowerHull> hull = lower_hull(points, options.curvature_per_m);
  if (!hull) {
    if (hull.error().code != ErrorCode::bad_input) return tl::make_unexpected(hull.error());
    out.unknown_reason = hull.error().why;
    return out;
  }
  const Surface surface = make_surface(cells, lows, *hull, points, options);
  out.median_lift_m = median_lift(surface, cells.halo(), reference.cells);
  fill_nodes(surface, cells.halo(), options, out);
  if (out.known_nodes == 0) out.unknown_reason = "no supported hits in the tile";
  return out;
}

}  // namespace rayfield::density
