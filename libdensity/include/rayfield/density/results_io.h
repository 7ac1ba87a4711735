#pragma once

#include <string>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/density/ground_model.h"
#include "rayfield/density/row_layout.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Stored form of what one scan gives, kind "results" version 1. Panels and rows are named by their numbers; their
/// UUIDs belong to the layout. The scan itself (ScanResults::scan) is the store's business and is not kept here.
tile::ArraySet results_to_arrays(const ScanResults& results, const RowLayout& layout, const std::string& crs);
/// `layout`, `crs`: give back the UUIDs; `scan`: what the values belong to. Errors: damaged.
Result<ScanResults> results_from_arrays(const tile::ArraySet& arrays, const RowLayout& layout, const std::string& crs,
                                        const ScanProduct& scan);

/// Stored form of a raster, kind "raster" version 1.
tile::ArraySet raster_to_arrays(const RasterProduct& raster);
/// Errors: damaged.
Result<RasterProduct> raster_from_arrays(const tile::ArraySet& arrays);

/// Identities: named UUIDs of the geometry in the layout, so that the same block gets the same ones on every machine.
/// They stay for as long as the layout is kept, which is for ever unless the user asks for a new one.
std::string row_uid(const Row& row, const std::string& crs);
std::string panel_uid(const Panel& panel, const RowLayout& layout, const std::string& crs);
std::string post_uid(const Post& post, const std::string& crs);

/// The layout as products. `half_width_m`: of the panels' outlines, about the canopy's. `ground` may lack places: the
/// height is NaN there.
BlockProducts layout_products(const RowLayout& layout, const std::string& block, const std::string& crs,
                              const GroundModel& ground, double half_width_m);

}  // namespace rayfield::density
