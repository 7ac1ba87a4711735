#pragma once

#include <span>
#include <vector>

#include "libdensity/estimate/row_density.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"

/// integration: from the densities of a row to panels, half metres, sections and maps. Densities are integrated, never
/// averaged over a canopy outline: outlines are ill-defined.
namespace rayfield::density {

/// Values of the row's panels, in their order; identities (panel_uid, scan) are left to the caller. `panels`: of this
/// row, ordered along it. What lies beyond the first and last panel belongs to them, what lies between two to the
/// nearer one, so that the panels' sum is the row's. Columns cut by a border are shared by length.
/// plant_area_m2 = everything; leaf_area_m2 = plant area less masked wood (posts, trunks; wires and canes remain).
/// se_leaf_area_m2: square root of the summed voxel variances (voxels independent, see slab_density.h). The 95 %
/// interval adds an error that the whole panel shares, shared_error: a factor (interval.h).
/// ray_count: rays that enter the row's voxels in the panel.
std::vector<PanelValue> integrate_panels(const RowDensity& row, std::span<const Panel> panels, double row_spacing_m,
                                         const IntegrationOptions& options);

/// Areas per metre of row in steps of metre_step_m from chainage 0 to `row_length_m`; the ends take what lies beyond.
/// NaN where nothing was seen.
std::vector<RowMetreProduct> row_metres(const RowDensity& row, double row_length_m, const IntegrationOptions& options);

/// Plant area per area of the row's side, m²/m²: x along from the grid's start, y height above the ground.
/// NaN = no voxel there was seen.
SectionProduct side_view(const RowDensity& row);
/// Mean over the row's length of plant area density, m²/m³ (area per area of the end-on section and metre of row):
/// x across (positive left), y height. `row_length_m` > 0.
SectionProduct end_on_section(const RowDensity& row, double row_length_m);

/// Height above up_min of which `share` of the summed area lies below, linear inside a layer; NaN for no area.
double quantile_height(std::span<const double> layer_area, double layer_m, double share);

}  // namespace rayfield::density
