#include "libdensity/voxels/voxel_index.h"
#include "libdensity/tiles/rounding.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rayfield::density {
namespace {

/// Side of an index cell, m: about a canopy's width, so that a ray that crosses a row visits two or three cells.
constexpr double kCell = 1.0;
constexpr double kFar = 1e30;

Eigen::Vector3d row_frame(const RowSegment& s, const Eigen::Vector3d& g) {
  return {g.x() * s.voxel_m, g.y() * s.voxel_m + s.across_min_m, g.z() * s.voxel_m + s.up_min_m};
}

}  // namespace

GridFrame::GridFrame(const RowSegment& s) {
  const Eigen::RowVector3d along(s.direction.x(), s.direction.y(), 0), across(-s.direction.y(), s.direction.x(), 0);
  linear.row(0) = along / s.voxel_m;
  linear.row(1) = across / s.voxel_m;
  linear.row(2) = (Eigen::RowVector3d::UnitZ() - s.slope_along * along - s.slope_across * across) / s.voxel_m;
  origin = {s.origin.x(), s.origin.y(), s.ground_m};
  offset = {0, -s.across_min_m / s.voxel_m, -s.up_min_m / s.voxel_m};
}

VoxelIndex::VoxelIndex(std::span<const RowSegment> row_segments, std::span<const WoodCylinder> wood, double shell_m,
                       const Eigen::AlignedBox2d& bounds) {
  Eigen::AlignedBox2d box;
  for (const RowSegment& s : row_segments) {
    const GridFrame frame(s);
    for (int corner = 0; corner < 4; ++corner) {
      const Eigen::Vector3d g((corner & 1) ? s.n_along : 0, (corner & 2) ? s.n_across : 0, 0);
      box.extend(Eigen::Vector2d(frame.map_from_grid(g).head<2>()));
    }
  }
  box = box.intersection(bounds);
  if (box.isEmpty() || row_segments.empty()) return;
  origin_ = box.min() - Eigen::Vector2d::Constant(1e-6);
  nx_ = ceil_int((box.sizes().x() + 2e-6) / kCell);
  ny_ = ceil_int((box.sizes().y() + 2e-6) / kCell);
  words_ = static_cast<int>((row_segments.size() + wood.size() + 63) / 64);
  const std::size_t count = static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_);
  cells_.assign(count, {kFar, -kFar});
  masks_.assign(count * static_cast<std::size_t>(words_), 0);
  low_ = kFar, high_ = -kFar;
  int bit = 0;
  for (const RowSegment& s : row_segments) cover_row_segment(s, bit++);
  for (const WoodCylinder& w : wood) cover_cylinder(w, shell_m, bit++);
}

void VoxelIndex::cover_cell(int ix, int iy, int bit, double low, double high) {
  const std::size_t cell = at(ix, iy);
  masks_[cell * static_cast<std::size_t>(words_) + static_cast<std::size_t>(bit / 64)] |= std::uint64_t{1}
                                                                                          << (bit % 64);
  cells_[cell].low = std::min(cells_[cell].low, low), cells_[cell].high = std::max(cells_[cell].high, high);
  low_ = std::min(low_, low), high_ = std::max(high_, high);
}

void VoxelIndex::cover_row_segment(const RowSegment& s, int bit) {
  const Eigen::Vector2d u = s.direction, v(-u.y(), u.x());
  const double half_diagonal = kCell * std::sqrt(0.5);
  const double slack_z = half_diagonal * std::hypot(s.slope_along, s.slope_across) + 1e-6;
  const Eigen::Vector3d top = row_frame(s, Eigen::Vector3d(s.n_along, s.n_across, s.n_up));
  for (int iy = 0; iy < ny_; ++iy) {
    for (int ix = 0; ix < nx_; ++ix) {
      const Eigen::Vector2d from_origin = origin_ + kCell * Eigen::Vector2d(ix + 0.5, iy + 0.5) - s.origin;
      const double along = from_origin.dot(u), across = from_origin.dot(v);
      if (along < -half_diagonal || along > top.x() + half_diagonal || across < s.across_min_m - half_diagonal ||
          across > top.y() + half_diagonal)
        continue;
      const double ground = s.ground_m + s.slope_along * along + s.slope_across * across;
      cover_cell(ix, iy, bit, ground + s.up_min_m - slack_z, ground + top.z() + slack_z);
    }
  }
}

void VoxelIndex::cover_cylinder(const WoodCylinder& wood, double shell_m, int bit) {
  const Eigen::Vector3d tip = wood.base + wood.axis * (wood.length_m + shell_m);
  Eigen::AlignedBox2d box(Eigen::Vector2d(wood.base.head<2>().cwiseMin(tip.head<2>())),
                          Eigen::Vector2d(wood.base.head<2>().cwiseMax(tip.head<2>())));
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(wood.radius_m + wood.bend_m + shell_m);
  const Eigen::Vector2d lo = (box.min() - reach - origin_) / kCell, hi = (box.max() + reach - origin_) / kCell;
  if (hi.x() < 0 || hi.y() < 0 || lo.x() >= nx_ || lo.y() >= ny_) return;
  for (int iy = std::max(0, static_cast<int>(lo.y())); iy <= std::min(ny_ - 1, static_cast<int>(hi.y())); ++iy)
    for (int ix = std::max(0, static_cast<int>(lo.x())); ix <= std::min(nx_ - 1, static_cast<int>(hi.x())); ++ix)
      cover_cell(ix, iy, bit, kFar, -kFar);  // wood matters only where a row segment already claims the heights
}

bool VoxelIndex::candidates(const Eigen::Vector3d& p, const Eigen::Vector3d& d, double length,
                            std::uint64_t* mask) const {
  double t0 = 0, t1 = length;
  const auto clip = [&](double x, double dx, double lo, double hi) {
    if (dx == 0) return x >= lo && x <= hi;
    const double inv = 1 / dx;
    const double a = (lo - x) * inv, b = (hi - x) * inv;
    t0 = std::max(t0, std::min(a, b)), t1 = std::min(t1, std::max(a, b));
    return t0 <= t1;
  };
  if (nx_ == 0 || !clip(p.z(), d.z(), low_, high_) || !clip(p.x(), d.x(), origin_.x(), origin_.x() + nx_ * kCell) ||
      !clip(p.y(), d.y(), origin_.y(), origin_.y() + ny_ * kCell))
    return false;
  const double gx = (p.x() + t0 * d.x() - origin_.x()) / kCell, gy = (p.y() + t0 * d.y() - origin_.y()) / kCell;
  int ix = std::clamp(static_cast<int>(gx), 0, nx_ - 1), iy = std::clamp(static_cast<int>(gy), 0, ny_ - 1);
  const int sx = d.x() >= 0 ? 1 : -1, sy = d.y() >= 0 ? 1 : -1;
  const double never = std::numeric_limits<double>::infinity();
  const double step_x = d.x() != 0 ? kCell / std::abs(d.x()) : never,
               step_y = d.y() != 0 ? kCell / std::abs(d.y()) : never;
  double next_x = d.x() != 0 ? t0 + (d.x() > 0 ? ix + 1 - gx : gx - ix) * step_x : never;
  double next_y = d.y() != 0 ? t0 + (d.y() > 0 ? iy + 1 - gy : gy - iy) * step_y : never;
  bool any = false;
  double t = t0;
  // Cells are closed for rays that run along their borders: row segments and wood were entered with some slack.
  for (;;) {
    const double next = std::min({next_x, next_y, t1});
    const std::size_t cell = at(ix, iy);
    const double za = p.z() + t * d.z(), zb = p.z() + next * d.z();
    if (std::max(za, zb) >= cells_[cell].low && std::min(za, zb) <= cells_[cell].high) {
      any = true;
      for (int w = 0; w < words_; ++w)
        mask[w] |= masks_[cell * static_cast<std::size_t>(words_) + static_cast<std::size_t>(w)];
    }
    if (next >= t1) break;
    t = next;
    if (next_x <= next_y) {
      ix += sx, next_x += step_x;
      if (ix < 0 || ix >= nx_) break;
    } else {
      iy += sy, next_y += step_y;
      if (iy < 0 || iy >= ny_) break;
    }
  }
  return any;
}

}  // namespace rayfield::density
