#include "libdensity/layout/row_locator.h"
#include "libdensity/tiles/rounding.h"

#include <algorithm>
#include <cmath>

namespace rayfield::density {
namespace {

constexpr double kCell = 0.5;     // m
constexpr double kProlong = 1.0;  // m; how far points before the first and after the last vertex are looked at

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d d = b - a;
  const double t = std::clamp(d.dot(p - a) / std::max(d.squaredNorm(), 1e-12), 0.0, 1.0);
  return (p - a - t * d).norm();
}

}  // namespace

RowLocator::RowLocator(const RowLayout& layout, const tile::TileRef& tile, double margin_m, double half_width_m)
    : half_width_m_(half_width_m) {
  const int n = ceil_int((tile.size_m + 2 * margin_m) / kCell) + 1;
  const Eigen::Vector2d corner = tile.corner() - Eigen::Vector2d::Constant(margin_m);
  cells_ = Grid2<Nearest>(corner, kCell, n, n);
  const Eigen::Vector2d far_corner = corner + Eigen::Vector2d::Constant(n * kCell);
  const double reach = half_width_m + kProlong + kCell;
  for (std::size_t r = 0; r < layout.rows.size(); ++r) {
    const auto& line = layout.rows[r].centreline;
    std::vector<Segment>& segments = segments_.emplace_back();
    double along_m = 0;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const Eigen::Vector2d d = line[i + 1] - line[i];
      const double length_m = d.norm();
      segments.push_back({along_m, length_m, line[i], d / length_m});
      along_m += length_m;
    }
    std::optional<RowInterval> part;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const Eigen::Vector2d low = line[i].cwiseMin(line[i + 1]).array() - reach;
      const Eigen::Vector2d high = line[i].cwiseMax(line[i + 1]).array() + reach;
      if ((high.array() < corner.array()).any() || (low.array() > far_corner.array()).any()) continue;
      enter(line[i], line[i + 1], {static_cast<int>(r), static_cast<int>(i), 0}, reach);
      const double start_m = segments[i].chainage_m, end_m = start_m + segments[i].length_m;
      if (!part) part = RowInterval{static_cast<int>(r), start_m, end_m};
      part->start_m = std::min(part->start_m, start_m);
      part->end_m = std::max(part->end_m, end_m);
    }
    if (part) intervals_.push_back(*part);
  }
}

void RowLocator::enter(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Nearest& segment, double reach_m) {
  const Eigen::Vector2d low = (a.cwiseMin(b) - cells_.origin) / kCell, high = (a.cwiseMax(b) - cells_.origin) / kCell;
  const int ring = ceil_int(reach_m / kCell);
  const int x0 = std::max(0, floor_int(low.x()) - ring);
  const int x1 = std::min(cells_.nx - 1, floor_int(high.x()) + ring);
  const int y0 = std::max(0, floor_int(low.y()) - ring);
  const int y1 = std::min(cells_.ny - 1, floor_int(high.y()) + ring);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const float distance = static_cast<float>(distance_to_segment(cells_.center(x, y), a, b));
      Nearest& cell = cells_.at(x, y);
      if (static_cast<double>(distance) <= reach_m && (cell.row < 0 || distance < cell.distance))
        cell = {segment.row, segment.segment, distance};
    }
}

std::optional<RowLocator::Place> RowLocator::locate(const Eigen::Vector2d& p, double beyond_m) const {
  const int ix = floor_int((p.x() - cells_.origin.x()) / kCell);
  const int iy = floor_int((p.y() - cells_.origin.y()) / kCell);
  if (!cells_.contains(ix, iy) || cells_.at(ix, iy).row < 0) return std::nullopt;
  const Nearest& near = cells_.at(ix, iy);
  const std::vector<Segment>& segments = segments_[static_cast<std::size_t>(near.row)];
  const int last = static_cast<int>(segments.size()) - 1;
  std::optional<Place> best;
  double best_distance = half_width_m_;
  bool outside = false;
  for (int s = std::max(0, near.segment - 1); s <= std::min(last, near.segment + 1); ++s) {
    const Segment& segment = segments[static_cast<std::size_t>(s)];
    const double length = segment.length_m;
    if (length <= 0) continue;
    const Eigen::Vector2d& u = segment.direction;
    const Eigen::Vector2d r = p - segment.start;
    const double along = u.dot(r);
    // The outermost segments go on without end here, so that what lies past a row's end is not put beside it.
    const double t =
        std::clamp(along, s == 0 ? std::min(along, 0.0) : 0.0, s == last ? std::max(along, length) : length);
    const double distance = (r - t * u).norm();
    if (distance > best_distance) continue;
    best_distance = distance;
    outside = (s == 0 && along < -beyond_m) || (s == last && along > length + beyond_m);
    best = Place{near.row, segment.chainage_m + t, std::copysign(distance, u.x() * r.y() - u.y() * r.x())};
  }
  if (outside) return std::nullopt;
  return best;
}

}  // namespace rayfield::density
