#pragma once

#include <span>
#include <vector>

#include "libdensity/estimate/raster_frame.h"
#include "libdensity/estimate/row_density.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// Maps of a block, row by row. The area of every voxel column is shared out to the cells in proportion to the exact
/// overlap of the two squares, so that the raster's integral is the sum over the columns (to float precision).
/// A cell without a seen column is NaN; what a seen column does not cover counts as empty.
class PlanRaster {
 public:
  /// `frame`: of the block, with cells of options.cell_m; `row_segments`: all that may be added. Errors: usage;
  /// internal, when a row segment lies outside of the frame.
  static Result<PlanRaster> create(const RasterFrame& frame, std::span<const RowSegment> row_segments,
                                   const PlanRasterOptions& options);
  /// Rows in a fixed order give the same bytes.
  void add(const RowDensity& row);
  /// "plan_density" (plant area, m²/m²), "plan_density_se" (square root of the cell's variance: columns independent)
  /// and "canopy_height" (m above the ground, mean over the columns with canopy weighted by overlap; 0 = seen, empty).
  std::vector<RasterProduct> finish() const;

 private:
  struct Cell {
    double area = 0, variance = 0;  ///< plant area m², m⁴
    double height = 0, canopy = 0;  ///< Σ height·overlap, Σ overlap of columns with canopy
    double seen = 0;                ///< overlap with seen columns, m²
  };
  PlanRasterOptions options_;
  Grid2<Cell> cells_;
};

/// Area of the part of a convex polygon (counter-clockwise, at most 8 corners) inside an axis-parallel box, m².
double overlap_area(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& low, const Eigen::Vector2d& high);

}  // namespace rayfield::density
