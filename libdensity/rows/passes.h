#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "libdensity/ground/survey.h"
#include "rayfield/core/result.h"
#include "rayfield/density/layout_options.h"

namespace rayfield::density {

/// A piece of the trajectory without turns: one pass along one lane (or along a headland).
struct Pass {
  std::vector<Eigen::Vector2d> line;  ///< smoothed, equally spaced vertices, in the direction of driving, m
  double start_time_s = 0, end_time_s = 0;
  double length_m() const;
};

/// Cuts the trajectory at turns, reversals, standstills and jumps. Empty when nothing is long enough.
std::vector<Pass> find_passes(std::span<const PathPoint> path, const PassOptions& options);

}  // namespace rayfield::density
