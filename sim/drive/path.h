#pragma once

/// drive: how the vehicle moves: the way along the lanes, speed, suspension, and the trajectory as a smooth curve.

#include <vector>

#include "sim/drive/uniform_spline.h"
#include "sim/terrain/block_geometry.h"

namespace rayfield::sim {

/// The way over ground as a smooth plane curve over its control polygon's arc length (the curve itself is shorter by a
/// few per cent in turns).
struct Path {
  struct Span {
    double from = 0, to = 0;
  };
  UniformSpline<2> curve;
  std::vector<Span> turns;  ///< ranges of the parameter in headlands
};

/// Lanes in the order in which a date drives them.
std::vector<int> lane_order(const Site& site, const SiteDate& date);

/// The path through `lanes`, beginning and ending outside the rows; `seed` for the wander.
Path plan_path(const BlockGeometry& block, const std::vector<int>& lanes, double wander_m, std::uint64_t seed);

}  // namespace rayfield::sim
