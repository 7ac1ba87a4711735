#pragma once
/// results: the values of a scan as the store keeps them.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libdensity/ground/ground_model.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Stored form of what one scan gives, kind "results" version 1. Panels and rows are named by their numbers; their
/// UUIDs belong to the layout. The scan itself (ScanResults::scan) is the store's business and is not kept here.
/// `results.sections`: their grids need no values, which come from `section_values`, section after section.
tile::StreamedArrays results_to_arrays(const ScanResults& results, const RowLayout& layout,
                                       tile::ColumnSource section_values);

/// Of `arrays` without their column kSectionValues: everything but the sections. `layout`: gives back the UUIDs;
/// `scan`: what the values belong to. Errors: damaged.
Result<ScanResults> results_from_arrays(const tile::ArraySet& arrays, const RowLayout& layout, const ScanProduct& scan);
inline constexpr const char* kSectionValues = "section_values";
/// The sections, without their values. Errors: damaged, also when there are not as many values as they have cells.
Result<std::vector<SectionProduct>> sections_of(const tile::ArraySet& header, std::uint64_t value_count);

/// Stored form of a raster, kind "raster" version 1. `raster.grid` needs no values.
tile::StreamedArrays raster_to_arrays(const RasterProduct& raster, tile::ColumnSource values);
inline constexpr const char* kRasterValues = "values";
/// Everything but the values. Errors: damaged, also when there are not as many values as it has cells.
Result<RasterProduct> raster_of(const tile::ArraySet& header, std::uint64_t value_count);

/// Values of maps and sections are numbers or NaN. Errors: damaged, with `name`, where one is infinite.
Result<void> check_map_values(std::span<const float> values, const std::string& name);

}  // namespace rayfield::density
