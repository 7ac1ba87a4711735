#pragma once

#include <cstddef>

#include "rayfield/core/option_fields.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/core/season_products.h"

/// Two dates of a block against each other (docs/compare.md).
namespace rayfield::density {

struct ComparisonOptions {
  double error_correlation = 0.8;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("error_correlation", o.error_correlation, {0, 1},
             "How much of the error that all voxels of a panel share (leaf angles, clumping) is the same on both "
             "dates, as a correlation; 1: it only scales a change, 0: as if the dates were of two different vineyards");
  }
  Result<void> validate() const;
};

/// Compares scan `a` with scan `b` (places in block.scans), panel by panel.
///
/// The interval of a panel holds two errors: that of its voxels, s (se_leaf_area_m2), independent between dates, and
/// one that all voxels share, c = √(((ci_high − leaf)/1.96)² − s²), which has correlation ρ between dates. The change b
/// − a has the variance
///   s_a² + s_b² + c_a² + c_b² − 2ρ·c_a·c_b
/// and is a gain or a loss where |b − a| > 1.96 times its root. The panels' sum adds s² over the panels, and c itself:
/// what leaf angles do to one panel they do to all. Plant area changes by the same leaves and has the same error.
/// Panels without a value on one of the dates are counted and left out.
/// Errors: usage (options, a place beyond the scans, the same scan twice); bad_input (no panel was seen on both).
Result<DateComparison> compare_dates(const BlockProducts& block, std::size_t a, std::size_t b,
                                     const ComparisonOptions& options);

/// b − a cell by cell, NaN where one of them is. Named "<name>_change". Errors: usage (the rasters do not lie upon each
/// other, or are of two products).
Result<RasterProduct> raster_change(const RasterProduct& a, const RasterProduct& b);

}  // namespace rayfield::density
