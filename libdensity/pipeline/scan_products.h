#pragma once
/// pipeline: the products of a scan, and the order in which all stages run.
#include "libdensity/leaf/leaf_products.h"
#include "libdensity/scan/scan_stages.h"
#include "rayfield/core/products.h"

namespace rayfield::density {

/// Panels, half metres, sections and rasters from the counters (kinds "results" and "raster").
Result<ScanResults> integrate_scan(ScanWork& work, const RowLayout& layout, const SurveyedScan& surveyed,
                                   const ScanVoxels& voxels);

}  // namespace rayfield::density
