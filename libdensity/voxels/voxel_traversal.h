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
  std::size_t steepness = 0;  ///< of the ray; for DirectionCounters
};

/// What of a beam belongs to its ray.
struct WideRay {
  double width_at_origin_m, divergence_rad;  ///< diameter at t metres along the ray: width_at_origin_m + divergence·t
  std::uint16_t intensity;                   ///< of the echo
};

inline std::int64_t fixed(double u) { return std::llrint(u * (1.0 / VoxelCounters::kUnit)); }

/// Where the line g0 + t·dg (voxel coordinates) runs in a grid.
struct GridChord {
  double from, to;
  int face;  ///< axis of the face through which it comes in; −1: `from` was inside
};

/// The part from `from` to `to` inside the grid; false where there is none.
inline bool clip_to_grid(const int (&n)[3], const Eigen::Vector3d& g0, const Eigen::Vector3d& dg, GridChord& chord) {
  chord.face = -1;
  for (int k = 0; k < 3; ++k) {
    if (dg[k] == 0) {
      if (g0[k] < 0 || g0[k] >= n[k]) return false;
      continue;
    }
    const double inv = 1 / dg[k];
    const double a = -g0[k] * inv, b = (n[k] - g0[k]) * inv;
    const double in = std::min(a, b);
    if (in > chord.from) chord.from = in, chord.face = k;
    chord.to = std::min(chord.to, std::max(a, b));
    if (!(chord.from < chord.to)) return false;
  }
  return true;
}

/// One voxel on the way.
struct VoxelStep {
  std::int32_t column;  ///< −1: of another tile
  std::size_t voxel;    ///< in RowSegmentVoxels::voxels; of no meaning without a column
  double from, to;      ///< along the ray, m
  double face;          ///< where the straight line would leave the voxel, at `to` or beyond
  bool first, last;     ///< of the chord
};

/// Calls visit(step) for the voxels along a chord in order (Amanatides & Woo 1987, in the sheared frame; t stays true
/// metres).
template <class Visit>
inline void walk(const RowSegmentVoxels& sums, const Eigen::Vector3d& g0, const Eigen::Vector3d& dg,
                 const GridChord& chord, Visit visit) {
  const Shape3 shape = sums.row_segment.shape();
  const int n[3] = {shape.ni, shape.nj, shape.nk};
  const double never = std::numeric_limits<double>::infinity();
  int i[3], step[3];
  double next[3], delta[3];
  for (int k = 0; k < 3; ++k) {
    const double g = g0[k] + chord.from * dg[k];
    i[k] = std::clamp(floor_int(g), 0, n[k] - 1);
    if (k == chord.face) i[k] = dg[k] > 0 ? 0 : n[k] - 1;
    step[k] = dg[k] >= 0 ? 1 : -1;
    delta[k] = dg[k] != 0 ? 1 / std::abs(dg[k]) : never;
    next[k] = dg[k] != 0 ? (i[k] + (dg[k] > 0 ? 1 : 0) - g0[k]) / dg[k] : never;
  }
  const auto n_up = static_cast<std::size_t>(n[2]);
  bool first = true;
  double t = chord.from;
  for (;;) {
    const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    const bool last = !(next[axis] < chord.to);
    const std::int32_t column = sums.column[shape.column(i[0], i[1])];
    const double t_exit = std::min(next[axis], chord.to);
    const std::size_t voxel = static_cast<std::size_t>(column) * n_up + static_cast<std::size_t>(i[2]);
    visit(VoxelStep{column, voxel, t, t_exit, next[axis], first, last});
    if (last) return;
    first = false;
    t = t_exit;
    i[axis] += step[axis];
    if (i[axis] < 0 || i[axis] >= n[axis]) return;
    next[axis] += delta[axis];
  }
}

/// Adds a piece of the ray g0 + t·dg (voxel coordinates, t in metres) to every voxel that it crosses. Every hit inside
/// the grid is counted in exactly one voxel: the one in which the piece ends; returns whether that voxel is one of this
/// tile's. `wide`: for grids with EchoCounters.
template <bool Wide>
inline bool traverse(RowSegmentVoxels& sums, const Eigen::Vector3d& g0, const Eigen::Vector3d& dg,
                     const RayPiece& piece, const WideRay& wide) {
  const Shape3 shape = sums.row_segment.shape();
  const int n[3] = {shape.ni, shape.nj, shape.nk};
  GridChord chord{piece.from, piece.to, -1};
  if (!clip_to_grid(n, g0, dg, chord)) return false;
  const bool hit_inside = piece.hit && chord.to == piece.to;
  const bool counts_entry = piece.first && (chord.face == 1 || chord.face == 2 || (chord.face < 0 && piece.starts));
  const double to_voxels = 1 / sums.row_segment.voxel_m;
  bool hit_counted = false;
  walk(sums, g0, dg, chord, [&](const VoxelStep& at) {
    const bool hit_here = at.last && hit_inside;
    if (at.column < 0 || !(at.to > at.from || hit_here)) return;
    VoxelCounters& v = sums.voxels[at.voxel];
    const double x = std::max(0.0, at.to - at.from) * to_voxels;
    const std::int64_t u = fixed(x * piece.doubled_projection);
    ++v.rays;
    v.path += u;
    if (!hit_here) {
      v.potential += u;
    } else {
      ++v.hits;
      v.hit_path += u;
      v.potential += std::max(u, fixed((at.face - at.from) * to_voxels * piece.doubled_projection));
      hit_counted = true;
    }
    if (at.first && counts_entry) ++sums.entries[at.column];
    if constexpr (Wide) {
      EchoCounters& e = sums.echoes[at.voxel];
      const double middle = (at.from + at.to) / 2;
      const std::int64_t path = EchoCounters::path_units(x * piece.doubled_projection);
      e.width += path * EchoCounters::width_units(wide.width_at_origin_m + wide.divergence_rad * middle);
      if (hit_here) e.echo += wide.intensity;
    }
  });
  return hit_counted;
}

/// Adds the path behind an echo: `piece` begins there.
inline void add_behind(RowSegmentVoxels& sums, const Eigen::Vector3d& g0, const Eigen::Vector3d& dg,
                       const RayPiece& piece, std::uint16_t intensity) {
  const Shape3 shape = sums.row_segment.shape();
  const int n[3] = {shape.ni, shape.nj, shape.nk};
  GridChord chord{piece.from, piece.to, -1};
  if (!clip_to_grid(n, g0, dg, chord)) return;
  const double to_units = piece.doubled_projection / sums.row_segment.voxel_m;
  walk(sums, g0, dg, chord, [&](const VoxelStep& at) {
    if (at.column < 0) return;
    EchoCounters& e = sums.echoes[at.voxel];
    const std::int64_t path = EchoCounters::path_units(std::max(0.0, at.to - at.from) * to_units);
    e.behind += path;
    e.echo_behind += path * intensity;
  });
}

/// For DirectionCounters. Thin beams: at range 0 all along, with hits of intensity 1.
struct DirectedRay {
  double range_at_origin_m, range_per_m;  ///< range at t metres along the ray: range_at_origin_m + range_per_m·t
  std::uint16_t intensity;                ///< of the echo
};

/// As traverse(), but into the DirectionCounters.
inline void add_directions(RowSegmentVoxels& sums, const Eigen::Vector3d& g0, const Eigen::Vector3d& dg,
                           const RayPiece& piece, const DirectedRay& ray) {
  const Shape3 shape = sums.row_segment.shape();
  const int n[3] = {shape.ni, shape.nj, shape.nk};
  GridChord chord{piece.from, piece.to, -1};
  if (!clip_to_grid(n, g0, dg, chord)) return;
  const bool hit_inside = piece.hit && chord.to == piece.to;
  const double to_voxels = 1 / sums.row_segment.voxel_m;
  walk(sums, g0, dg, chord, [&](const VoxelStep& at) {
    if (at.column < 0) return;
    DirectionCounters& d = sums.directions[at.voxel];
    const double range_m = ray.range_at_origin_m + ray.range_per_m * at.to;
    const std::size_t bin = DirectionCounters::bin_of(piece.steepness, range_m);
    d.add_path(bin, std::max(0.0, at.to - at.from) * to_voxels);
    if (at.last && hit_inside) d.hits[bin] += ray.intensity;
  });
}

/// Likewise the path behind an echo, of which `passed` is the share of the beam that goes on.
inline void add_directions_behind(RowSegmentVoxels& sums, const Eigen::Vector3d& g0, const Eigen::Vector3d& dg,
                                  const RayPiece& piece, double passed, double range_m) {
  const Shape3 shape = sums.row_segment.shape();
  const int n[3] = {shape.ni, shape.nj, shape.nk};
  GridChord chord{piece.from, piece.to, -1};
  if (!clip_to_grid(n, g0, dg, chord)) return;
  const std::size_t bin = DirectionCounters::bin_of(piece.steepness, range_m);
  const double to_voxels = passed / sums.row_segment.voxel_m;
  walk(sums, g0, dg, chord, [&](const VoxelStep& at) {
    if (at.column >= 0) sums.directions[at.voxel].add_path(bin, std::max(0.0, at.to - at.from) * to_voxels);
  });
}

}  // namespace rayfield::density
