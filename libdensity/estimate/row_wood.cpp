#include "libdensity/estimate/row_wood.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "libdensity/tiles/rounding.h"
#include "libdensity/voxels/voxel_index.h"

namespace rayfield::density {
namespace {

constexpr int kRingPoints = 32;      // points round a cylinder
constexpr double kRingStepM = 0.01;  // and between rings
constexpr int kShareSamples = 8;     // per side of a column
constexpr double kRounding = 1e-6;   // voxels; far more than coordinates lose on the way into a grid

/// A row segment as part of the row's grid.
struct Piece {
  GridFrame frame;
  int first = 0, n_along = 0;                        ///< its columns along the row
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();   ///< from its own voxel coordinates, across and up
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< of its first column, in plan
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();

  /// How far a coordinate along lies outside of the piece, voxels.
  double beyond(double along) const { return std::max({0.0, -along, along - n_along}); }
};

std::vector<Piece> pieces_of(const RowDensity& row) {
  std::vector<Piece> pieces;
  int first = 0;
  for (const RowSegment& s : row.row_segments) {
    const Eigen::Vector3d shift(0, std::round((s.across_min_m - row.across_min_m) / row.voxel_m),
                                std::round((s.up_min_m - row.up_min_m) / row.voxel_m));
    pieces.push_back({GridFrame(s), first, s.n_along, shift, s.origin, s.direction});
    first += s.n_along;
  }
  return pieces;
}

/// The pieces that may be the nearest one along the row to some point of the cylinder's surface, in order. A
/// cylinder's coordinates along a piece are those of its axis' ends, less and more its radius, and what lies between.
std::vector<const Piece*> pieces_near(const std::vector<Piece>& pieces, const WoodCylinder& wood) {
  struct Reach {
    double least, most;  // of beyond()
  };
  std::vector<Reach> reaches;
  double surely = std::numeric_limits<double>::infinity();
  for (const Piece& piece : pieces) {
    const double base = piece.frame.grid_from_map(wood.base).x();
    const double top = piece.frame.grid_from_map(wood.base + wood.length_m * wood.axis).x();
    const double around = wood.radius_m * piece.frame.linear.row(0).norm() + kRounding;
    const double low = std::min(base, top) - around, high = std::max(base, top) + around;
    const double nearest = std::max({0.0, -high, low - piece.n_along});
    reaches.push_back({nearest, std::max(piece.beyond(low), piece.beyond(high))});
    surely = std::min(surely, reaches.back().most);
  }
  std::vector<const Piece*> near;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (reaches[i].least <= surely) near.push_back(&pieces[i]);
  return near;
}

/// The voxel of the row nearest along it to a map point, not yet brought into the grid across and upwards.
struct Located {
  int along = 0;
  Eigen::Vector3d grid = Eigen::Vector3d::Zero();
};

Located locate(const std::vector<const Piece*>& near, const Eigen::Vector3d& p) {
  double best = std::numeric_limits<double>::infinity();
  Located out;
  for (const Piece* piece : near) {
    const Eigen::Vector3d g = piece->frame.grid_from_map(p);
    const double beyond = piece->beyond(g.x());
    if (beyond >= best) continue;
    best = beyond;
    out.along = piece->first + std::clamp(floor_int(g.x()), 0, piece->n_along - 1);
    out.grid = g + piece->shift;
  }
  return out;
}

void add_wood_area(RowDensity& row, const std::vector<Piece>& pieces, const WoodCylinder& wood) {
  const std::vector<const Piece*> near = pieces_near(pieces, wood);
  const Eigen::Vector3d e1 = wood.axis.unitOrthogonal(), e2 = wood.axis.cross(e1);
  const int rings = std::max(1, ceil_int(wood.length_m / kRingStepM));
  const double area = std::numbers::pi * wood.radius_m * wood.length_m / (rings * kRingPoints);
  for (int ring = 0; ring < rings; ++ring)
    for (int k = 0; k < kRingPoints; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.5) / kRingPoints;
      const Eigen::Vector3d p = wood.base + wood.axis * (wood.length_m * (ring + 0.5) / rings) +
                                wood.radius_m * (std::cos(angle) * e1 + std::sin(angle) * e2);
      const Located at = locate(near, p);
      if (at.grid.z() < 0) continue;
      const int across = std::clamp(floor_int(at.grid.y()), 0, row.n_across - 1);
      const int up = std::clamp(floor_int(at.grid.z()), 0, row.n_up - 1);
      row.wood_area[row.index(at.along, across, up)] += static_cast<float>(area);
    }
}

/// `from_axis`: of the column's centre.
float covered_share(const Eigen::Vector2d& from_axis, const Eigen::Vector2d& u, double voxel_m, double radius_m) {
  const Eigen::Vector2d v(-u.y(), u.x());
  int inside = 0;
  for (int i = 0; i < kShareSamples; ++i)
    for (int j = 0; j < kShareSamples; ++j) {
      const Eigen::Vector2d q =
          from_axis + voxel_m * (((i + 0.5) / kShareSamples - 0.5) * u + ((j + 0.5) / kShareSamples - 0.5) * v);
      if (q.norm() < radius_m) ++inside;
    }
  return static_cast<float>(inside) / (kShareSamples * kShareSamples);
}

void take_free_share(RowDensity& row, const std::vector<Piece>& pieces, const WoodCylinder& wood) {
  const Eigen::Vector2d base = wood.base.head<2>() + 0.5 * wood.length_m * wood.axis.head<2>();
  const double reach = wood.radius_m + row.voxel_m;
  for (const Piece& piece : pieces) {
    // A column further off along the piece is further off altogether; one more to be sure.
    const double along = (base - piece.origin).dot(piece.direction) / row.voxel_m, columns = reach / row.voxel_m + 1;
    if (along + columns < 0 || along - columns > piece.n_along) continue;
    const int from = std::max(0, floor_int(along - columns));
    const int to = std::min(piece.n_along - 1, ceil_int(along + columns));
    for (int a = piece.first + from; a <= piece.first + to; ++a)
      for (int c = 0; c < row.n_across; ++c) {
        const Eigen::Vector2d from_axis = row.center(a, c) - base;
        if (from_axis.norm() > reach) continue;
        float& share = row.free_share[row.column_index(a, c)];
        share = std::max(0.0F, share - covered_share(from_axis, piece.direction, row.voxel_m, wood.radius_m));
      }
  }
}

}  // namespace

void add_wood(RowDensity& row, std::span<const WoodCylinder> wood) {
  if (wood.empty()) return;
  row.wood_area.assign(row.shape().size(), 0);
  row.free_share.assign(row.shape().columns(), 1);
  const std::vector<Piece> pieces = pieces_of(row);
  for (const WoodCylinder& cylinder : wood) {
    add_wood_area(row, pieces, cylinder);
    take_free_share(row, pieces, cylinder);
  }
}

}  // namespace rayfield::density
