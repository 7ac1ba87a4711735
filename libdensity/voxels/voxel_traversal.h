#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "libdensity/tiles/rounding.h"
#include "libdensity/voxels/voxel_grid.h"

namespace rayfield::density {

/// One unbroken piece of a ray, from t = `from` to t = `to` metres along it.
struct RayPiece {
  double from, to;
  double doubled_projection;  ///< 2·G(θ) of the ray
  bool hit;                   ///< a surface at `to`
  bool first;                 ///< nothing of the segment lies before it
  bool starts;                ///< the ray itself starts at `from`
};

inline std::int64_t fixed(double u) { return std::llrint(u * (1.0 / VoxelCounters::kUnit)); }

/// Adds a piece of the ray g0 + t·dg (voxel coordinates, t in metres) to every voxel that it crosses (Amanatides & Woo
/// 1987, in the sheared frame; t stays true metres). Every hit inside the grid is counted in exactly one voxel: the
/// one in which the piece ends; returns whether that voxel is one of this tile's.
inline bool traverse(RowSegmentVoxels& sums, const Eigen::Vector3d& g0, const Eigen::Vector3d& dg,
                     const RayPiece& piece) {
  const RowSegment& s = sums.row_segment;
  const Shape3 shape = s.shape();
  const int n[3] = {shape.ni, shape.nj, shape.nk};
  double t0 = piece.from, t1 = piece.to;
  int face = -1;  // axis of the face through which the ray comes in
  for (int k = 0; k < 3; ++k) {
    if (dg[k] == 0) {
      if (g0[k] < 0 || g0[k] >= n[k]) return false;
      continue;
    }
    const double inv = 1 / dg[k];
    const double a = -g0[k] * inv, b = (n[k] - g0[k]) * inv;
    const double in = std::min(a, b);
    if (in > t0) t0 = in, face = k;
    t1 = std::min(t1, std::max(a, b));
    if (!(t0 < t1)) return false;
  }
  const bool hit_inside = piece.hit && t1 == piece.to;
  const double never = std::numeric_limits<double>::infinity();
  int i[3], step[3];
  double next[3], delta[3];
  for (int k = 0; k < 3; ++k) {
    const double g = g0[k] + t0 * dg[k];
    i[k] = std::clamp(floor_int(g), 0, n[k] - 1);
    if (k == face) i[k] = dg[k] > 0 ? 0 : n[k] - 1;
    step[k] = dg[k] >= 0 ? 1 : -1;
    delta[k] = dg[k] != 0 ? 1 / std::abs(dg[k]) : never;
    next[k] = dg[k] != 0 ? (i[k] + (dg[k] > 0 ? 1 : 0) - g0[k]) / dg[k] : never;
  }
  const double to_voxels = 1 / s.voxel_m;
  const auto n_up = static_cast<std::size_t>(n[2]);
  const bool counts_entry = piece.first && (face == 1 || face == 2 || (face < 0 && piece.starts));
  bool at_entry = counts_entry;
  double t = t0;
  for (;;) {
    const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    const double t_exit = std::min(next[axis], t1);
    const bool last = !(next[axis] < t1);
    const bool hit_here = last && hit_inside;
    const std::int32_t column = sums.column[shape.column(i[0], i[1])];
    if (column >= 0 && (t_exit > t || hit_here)) {
      VoxelCounters& v = sums.voxels[static_cast<std::size_t>(column) * n_up + static_cast<std::size_t>(i[2])];
      const double x = std::max(0.0, t_exit - t) * to_voxels;
      const std::int64_t u = fixed(x * piece.doubled_projection);
      ++v.rays;
      v.path += u;
      if (!hit_here) {
        v.potential += u;
      } else {
        ++v.hits;
        v.hit_path += u;
        v.potential += std::max(u, fixed((next[axis] - t) * to_voxels * piece.doubled_projection));
      }
      if (at_entry) ++sums.entries[column];
    }
    at_entry = false;
    if (last) return hit_here && column >= 0;
    t = t_exit;
    i[axis] += step[axis];
    if (i[axis] < 0 || i[axis] >= n[axis]) return false;
    next[axis] += delta[axis];
  }
}

}  // namespace rayfield::density
