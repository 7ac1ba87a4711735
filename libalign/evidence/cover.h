#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "rayfield/core/grid2.h"

namespace rayfield::align {

/// What lies within `reach_m` of some points: of the vehicle's track (where a scan looked closely), of rows.
class Cover {
 public:
  Cover(std::span<const Eigen::Vector2d> points, double reach_m);
  bool contains(const Eigen::Vector2d& p) const;

 private:
  Grid2<std::uint8_t> cells_;
};

}  // namespace rayfield::align
