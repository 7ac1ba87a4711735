#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "libdensity/layout/row_layout.h"
#include "rayfield/core/grid2.h"
#include "rayfield/core/result.h"

namespace rayfield::density {

/// Where a map of a block lies: the same for all its dates, so that GIS programs subtract them cell by cell. It follows
/// from the layout and the cell size alone, not from what was scanned or how far the canopy reached.
struct RasterFrame {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< south-west corner, m
  double cell_m = 0.1;
  int nx = 0, ny = 0;

  bool contains(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d c = (p - origin) / cell_m;
    return c.x() >= 0 && c.y() >= 0 && c.x() <= nx && c.y() <= ny;
  }
};

/// Frames begin and end at multiples of so many cells in map coordinates: a frame that grows when a row is planted
/// keeps its cells where they were, and overviews of six levels have the same cells on all dates and in all blocks.
inline constexpr int kFrameStep_cells = 64;

/// The smallest such frame around a box. Errors: usage (an empty box), resources (beyond 2³¹ cells).
Result<RasterFrame> frame_around(const Eigen::AlignedBox2d& box, double cell_m);

/// Of the canopy's maps: the rows, and around them what their voxels and lanes can reach on any date (half the spacing
/// of the rows or 3 m, and 1 m more). Errors: as frame_around().
Result<RasterFrame> plan_frame(const RowLayout& layout, double cell_m);

/// Of the ground's map: the rows, and 10 m of headland around them.
Result<RasterFrame> ground_frame(const RowLayout& layout, double cell_m);

/// A map moved into a frame by whole cells: cells outside are dropped, missing ones are NaN.
class FittedMap {
 public:
  /// `map`: needs no values. Errors: usage, when its cells have another size or do not lie on the frame's.
  static Result<FittedMap> create(const Grid2<float>& map, const RasterFrame& frame);

  const RasterFrame& frame() const { return frame_; }
  /// One row of the frame. read(first, values) → Result<void> fills `values` with the map's from index `first` on.
  template <class Read>
  Result<void> read_row(int iy, std::span<float> row, Read&& read) const {
    std::fill(row.begin(), row.end(), std::numeric_limits<float>::quiet_NaN());
    const int y = iy - dy_, first = std::max(0, -dx_), last = std::min(nx_, frame_.nx - dx_);
    if (y < 0 || y >= ny_ || first >= last) return {};
    const auto width = static_cast<std::size_t>(last - first);
    return read(static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(nx_) + static_cast<std::uint64_t>(first),
                row.subspan(static_cast<std::size_t>(first + dx_), width));
  }

 private:
  RasterFrame frame_;
  int dx_ = 0, dy_ = 0, nx_ = 0, ny_ = 0;  // the map's first cell in the frame; its size
};

}  // namespace rayfield::density
