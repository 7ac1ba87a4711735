#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "libdensity/estimate/row_density.h"
#include "libdensity/integration/paged_grid.h"
#include "libdensity/integration/raster_frame.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// Maps of a block, row by row. The area of every voxel column is shared out to the cells in proportion to the exact
/// overlap of the two squares, so that the raster's integral is the sum over the columns (to float precision).
/// A cell without a seen column is NaN; what a seen column does not cover counts as empty. The block may be larger than
/// memory: see PagedGrid.
class PlanRaster {
 public:
  /// `frame`: of the block, with cells of options.cell_m; `row_segments`: all that may be added; `bytes`: bounds what
  /// is in memory of the cells; `folder`: of a temporary file for the others. Errors: usage; internal, when a row
  /// segment lies outside of the frame.
  static Result<PlanRaster> create(const RasterFrame& frame, std::span<const RowSegment> row_segments,
                                   const PlanRasterOptions& options, std::size_t bytes,
                                   const std::filesystem::path& folder);
  /// Rows in a fixed order give the same bytes. Errors: resources, as all that follow.
  Result<void> add(const RowDensity& row);
  /// The cell around a map point was scanned: it is empty where no column says otherwise. Nothing beyond the frame.
  Result<void> mark_scanned(const Eigen::Vector2d& p_in_map);

  /// "plan_density" (plant area, m²/m²), "plan_density_se" (square root of the cell's variance: columns independent)
  /// and "canopy_height" (m above the ground, mean over the columns with canopy weighted by overlap; 0 = seen, empty):
  /// names, units and frame; their grids hold no values.
  std::vector<RasterProduct> maps() const;
  /// Values of maps()[map] from index `first` of its grid on. Quickest in ascending order.
  Result<void> read(std::size_t map, std::uint64_t first, std::span<float> values);

 private:
  struct Cell {
    double area = 0, variance = 0;  ///< plant area m², m⁴
    double height = 0, canopy = 0;  ///< Σ height·overlap, Σ overlap of columns with canopy
    double seen = 0;                ///< overlap with seen columns, m²
    bool scanned = false;           ///< mark_scanned()
  };
  struct Band {  ///< rows of one map that were read last
    std::size_t map = 0;
    int number = -1;
    std::vector<float> values;
  };
  PlanRaster(const RasterFrame& frame, const PlanRasterOptions& options, std::size_t bytes,
             const std::filesystem::path& folder)
      : options_(options), frame_(frame), cells_(frame.nx, frame.ny, bytes, folder) {}
  Result<void> add_column(const RowDensity& row, int along, int across, std::vector<double>& layers);
  float value(const Cell& cell, std::size_t map) const;

  PlanRasterOptions options_;
  RasterFrame frame_;
  PagedGrid<Cell> cells_;
  Band band_;
};

/// Area of the part of a convex polygon (counter-clockwise, at most 8 corners) inside an axis-parallel box, m².
double overlap_area(std::span<const Eigen::Vector2d> polygon, const Eigen::Vector2d& low, const Eigen::Vector2d& high);

}  // namespace rayfield::density
