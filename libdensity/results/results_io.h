#pragma once

#include <string>

#include "libdensity/ground/ground_model.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Stored form of what one scan gives, kind "results" version 1. Panels and rows are named by their numbers; their
/// UUIDs belong to the layout. The scan itself (ScanResults::scan) is the store's business and is not kept here.
tile::ArraySet results_to_arrays(const ScanResults& results, const RowLayout& layout);
/// `layout`: gives back the UUIDs; `scan`: what the values belong to. Errors: damaged.
Result<ScanResults> results_from_arrays(const tile::ArraySet& arrays, const RowLayout& layout, const ScanProduct& scan);

/// Stored form of a raster, kind "raster" version 1.
tile::ArraySet raster_to_arrays(const RasterProduct& raster);
/// Errors: damaged.
Result<RasterProduct> raster_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
