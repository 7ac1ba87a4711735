#include "libalign/evidence/upright_index.h"

#include <cmath>

namespace rayfield::align {
namespace {

std::int64_t cell_of(double value, double cell_m) { return static_cast<std::int64_t>(std::floor(value / cell_m)); }

}  // namespace

UprightIndex::UprightIndex(std::span<const Upright> uprights, double cell_m) : uprights_(uprights), cell_m_(cell_m) {
  if (!uprights.empty()) origin_ = uprights.front().position;
  for (std::size_t i = 0; i < uprights.size(); ++i) {
    const Eigen::Vector2d p = uprights[i].position - origin_;
    cells_[key(cell_of(p.x(), cell_m), cell_of(p.y(), cell_m))].push_back(static_cast<int>(i));
  }
}

int UprightIndex::nearest(const Eigen::Vector2d& p, double radius_m) const {
  const Eigen::Vector2d local = p - origin_;
  const std::int64_t ix = cell_of(local.x(), cell_m_), iy = cell_of(local.y(), cell_m_);
  double best = radius_m * radius_m;
  int found = -1;
  for (std::int64_t y = iy - 1; y <= iy + 1; ++y)
    for (std::int64_t x = ix - 1; x <= ix + 1; ++x) {
      const auto cell = cells_.find(key(x, y));
      if (cell == cells_.end()) continue;
      for (const int i : cell->second) {
        const double distance = (uprights_[static_cast<std::size_t>(i)].position - p).squaredNorm();
        if (distance < best) best = distance, found = i;
      }
    }
  return found;
}

std::vector<int> UprightIndex::within(const Eigen::Vector2d& p, double radius_m) const {
  std::vector<int> found;
  for (std::size_t i = 0; i < uprights_.size(); ++i)
    if ((uprights_[i].position - p).squaredNorm() <= radius_m * radius_m) found.push_back(static_cast<int>(i));
  return found;
}

}  // namespace rayfield::align
