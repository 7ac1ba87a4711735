#include "sim/terrain/block_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rayfield::sim {

BlockGeometry::BlockGeometry(const SiteRows& rows)
    : rows_(rows), curvature_(rows.curve_radius_m == 0 ? 0 : 1 / rows.curve_radius_m) {
  const double azimuth = rows.azimuth_deg * std::numbers::pi / 180;
  sin_azimuth_ = std::sin(azimuth), cos_azimuth_ = std::cos(azimuth);
  half_extent_.setZero();
  for (int row = 0; row < rows.count; ++row)
    for (const double along : {-0.5, 0.0, 0.5})
      half_extent_ = half_extent_.cwiseMax(block_point(row_lateral(row), along * rows.length_m).cwiseAbs());
}

// Angle between the tangent and the azimuth, clockwise (towards v).
double BlockGeometry::heading_in_block(double lateral, double along) const {
  if (curvature_ == 0) return 0;
  const double half = 0.5 * rows_.length_m;
  return std::clamp(along, -half, half) * curvature_ / (1 - lateral * curvature_);
}

Eigen::Vector2d BlockGeometry::block_point(double lateral, double along) const {
  if (curvature_ == 0) return {along, lateral};
  const double phi = heading_in_block(lateral, along);
  const double radius = 1 / curvature_ - lateral;
  const double beyond = along - phi * radius;
  return Eigen::Vector2d(radius * std::sin(phi), 1 / curvature_ - radius * std::cos(phi)) +
         beyond * Eigen::Vector2d(std::cos(phi), std::sin(phi));
}

Eigen::Vector2d BlockGeometry::point(double lateral, double along) const {
  return enu_from_block(block_point(lateral, along));
}

Eigen::Vector2d BlockGeometry::direction(double lateral, double along) const {
  const double phi = heading_in_block(lateral, along);
  return enu_from_block({std::cos(phi), std::sin(phi)});
}

BlockGeometry::RowPosition BlockGeometry::position_from(double lateral, const Eigen::Vector2d& uv) const {
  const double half = 0.5 * rows_.length_m;
  if (curvature_ == 0) return {uv.x() + half, uv.y() - lateral};
  const double sign = curvature_ > 0 ? 1 : -1;
  const double radius = std::abs(1 / curvature_ - lateral);
  // Mirrored to a curve to the right where need be.
  const Eigen::Vector2d from_center(uv.x(), std::abs(1 / curvature_) - sign * uv.y());
  const double along = radius * std::atan2(from_center.x(), from_center.y());
  if (std::abs(along) <= half) return {along + half, sign * (radius - from_center.norm())};
  const double end = along > 0 ? half : -half;
  const double phi = heading_in_block(lateral, end);
  const Eigen::Vector2d d = uv - block_point(lateral, end);
  return {half + end + d.x() * std::cos(phi) + d.y() * std::sin(phi), -d.x() * std::sin(phi) + d.y() * std::cos(phi)};
}

BlockGeometry::RowPosition BlockGeometry::row_position(int row, const Eigen::Vector2d& p) const {
  return position_from(row_lateral(row), block_from_enu(p));
}

int BlockGeometry::nearest_row(const Eigen::Vector2d& p) const {
  const double lateral = position_from(0, block_from_enu(p)).offset;
  const double row = std::round(lateral / rows_.spacing_m + 0.5 * (rows_.count - 1));
  return static_cast<int>(std::clamp(row, 0.0, rows_.count - 1.0));
}

Eigen::Vector2d BlockGeometry::enu_from_block(const Eigen::Vector2d& uv) const {
  return {uv.x() * sin_azimuth_ + uv.y() * cos_azimuth_, uv.x() * cos_azimuth_ - uv.y() * sin_azimuth_};
}

Eigen::Vector2d BlockGeometry::block_from_enu(const Eigen::Vector2d& en) const {
  return {en.x() * sin_azimuth_ + en.y() * cos_azimuth_, en.x() * cos_azimuth_ - en.y() * sin_azimuth_};
}

}  // namespace rayfield::sim
