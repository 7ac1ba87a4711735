#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "libdensity/ground/survey.h"
#include "rayfield/core/grid2.h"

namespace rayfield::density {

/// What the surveys of a scan's tiles say together: the vehicle's path, what was seen, which rays were kept. Small (a
/// few kB per tile), whereas the low histograms, which the ground alone is made of, are megabytes.
class ScanSurvey {
 public:
  /// Each tile once, in any order.
  void add(const TileSurvey& survey);

  /// The trajectory of the sensor, ascending in time.
  std::vector<PathPoint> path() const;

  /// Whether the scan kept its downward rays without a return, or had them restored (MissingRaySource).
  bool holds_downward_misses() const { return misses_.holds_downward(); }

  /// CoverageFlag bits by tile.
  const std::map<tile::TileIndex, Grid2<std::uint8_t>>& coverage() const { return coverage_; }

 private:
  double path_step_s_ = 0.1;
  std::map<std::int64_t, PathSum> path_;  // by step
  std::map<tile::TileIndex, Grid2<std::uint8_t>> coverage_;
  HorizonMisses misses_;
};

}  // namespace rayfield::density
