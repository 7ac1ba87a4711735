#pragma once

#include <span>
#include <vector>

#include "libdensity/estimate/row_density.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"

/// Leaves alone: what a scan sees less what a dormant scan of the same row sees, voxel by voxel.
namespace rayfield::density {

/// leaf = plant − wood in every voxel of one grid, both corrected for uneven density as the leaves alone show it
/// (uneven_density.h): thick wood is more uneven than leaves, and few leaves among it would read wrong otherwise;
/// variances, as far as they are of the sampling, add. Signed: where there are only canes their noise must be free to
/// fall on either side of zero, or the sum over a panel holds the half of it that was kept. What one of the two did not
/// see is unobserved and counts as 0. Masked wood is taken out of both alike and belongs to neither, and so the result
/// has none. Errors: internal, when the grids differ.
Result<RowDensity> subtract_wood(RowDensity plant, const RowDensity& wood);

/// Of one part of a row.
struct LeafSum {
  double leaf_m2 = 0;
  double wood_m2 = 0;            ///< that was subtracted
  double variance_m4 = 0;        ///< of the two scans' sampling, and of how leaves are turned
  double observed_fraction = 0;  ///< share of voxels that both scans crossed with at least two rays
};

/// Sums over the row's panels, as integrate_panels() cuts them. `leaf`: of subtract_wood(), `wood`: what was given to
/// it.
std::vector<LeafSum> leaf_of_panels(const RowDensity& leaf, const RowDensity& wood, std::span<const Panel> panels);
/// m²/m of every part of the row that row_metres() makes; NaN where nothing was seen by both.
std::vector<double> leaf_of_metres(const RowDensity& leaf, double row_length_m, double metre_step_m);

/// leaf_area_m2 and what follows from it, put in place of that of the plants. The standard error is that of the
/// sampling; the 95 % interval adds, relative to the leaves, what all voxels of the panel share and, relative to the
/// wood subtracted, what the two scans do not: reach_of(leaf, se² + (wood_error·wood)², shared_error), cut at 0. A
/// panel of which less than min_observed_fraction was seen in both has no leaf area.
void set_leaf_area(PanelValue& value, const LeafSum& sum, double length_m, double row_spacing_m,
                   const IntegrationOptions& integration, const LeafOptions& options);

}  // namespace rayfield::density
