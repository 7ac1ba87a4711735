#include "libalign/evidence/cover.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rayfield::align {
namespace {

constexpr double kCell = 0.25;  // m

int cell_of(double value) { return static_cast<int>(std::floor(value / kCell)); }

}  // namespace

Cover::Cover(std::span<const Eigen::Vector2d> points, double reach_m) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : points) box.extend(p);
  if (box.isEmpty()) return;
  const Eigen::Vector2d low = box.min().array() - reach_m - kCell, size = box.max() - low;
  cells_ = Grid2<std::uint8_t>(low, kCell, cell_of(size.x() + reach_m) + 2, cell_of(size.y() + reach_m) + 2);
  const int reach = static_cast<int>(std::ceil(reach_m / kCell));
  for (const Eigen::Vector2d& p : points) {
    const int ix = cell_of(p.x() - low.x()), iy = cell_of(p.y() - low.y());
    for (int y = std::max(0, iy - reach); y <= std::min(cells_.ny - 1, iy + reach); ++y)
      for (int x = std::max(0, ix - reach); x <= std::min(cells_.nx - 1, ix + reach); ++x)
        if ((cells_.center(x, y) - p).norm() <= reach_m) cells_.at(x, y) = 1;
  }
}

bool Cover::contains(const Eigen::Vector2d& p) const {
  const Eigen::Vector2d local = p - cells_.origin;
  const int ix = cell_of(local.x()), iy = cell_of(local.y());
  return cells_.contains(ix, iy) && cells_.at(ix, iy) != 0;
}

}  // namespace rayfield::align
