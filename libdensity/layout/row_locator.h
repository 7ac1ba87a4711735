#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "libdensity/layout/row_layout.h"
#include "rayfield/core/grid2.h"
#include "rayfield/tile/segments.h"

namespace rayfield::density {

/// A piece of a row.
struct RowInterval {
  int row = 0;  ///< index into RowLayout::rows
  double start_m = 0, end_m = 0;
};

/// Finds the nearest row to points of one widened tile, and the point's place along and across that row.
class RowLocator {
 public:
  /// Looks at rows up to `half_width_m` away.
  RowLocator(const RowLayout& layout, const tile::TileRef& tile, double margin_m, double half_width_m);

  struct Place {
    int row = 0;  ///< index into RowLayout::rows
    double chainage_m = 0, across_m = 0;
  };
  /// nullopt beyond half_width_m, before a row's start or after its end (each prolonged by `beyond_m`).
  std::optional<Place> locate(const Eigen::Vector2d& p_in_map, double beyond_m = 0) const;

  /// Rows that pass through the widened tile and the chainages between which they do.
  const std::vector<RowInterval>& intervals() const { return intervals_; }

 private:
  struct Nearest {
    std::int32_t row = -1, segment = 0;
    float distance = 0;
  };
  struct Segment {
    double chainage_m, length_m;
    Eigen::Vector2d start, direction;
  };
  /// Into the cells up to `reach_m` from a segment from `a` to `b`, to which it is nearer than those before.
  void enter(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Nearest& segment, double reach_m);

  double half_width_m_;
  std::vector<std::vector<Segment>> segments_;  // of every row
  Grid2<Nearest> cells_;
  std::vector<RowInterval> intervals_;
};

}  // namespace rayfield::density
