#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "formats/gis/vector_table.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/farm_profile.h"

namespace rayfield::formats {

/// Columns of the panels of one date, as all exchange formats have them.
std::vector<VectorColumn> panel_columns();

/// The panels of one scan in longitude and latitude, coloured by leaf area per metre. A panel without a value on that
/// scan has only its own columns. Errors: usage (CRS, `scan_index` beyond the scans), internal (coordinates).
Result<VectorTable> panel_table(const BlockProducts& block, std::size_t scan_index, std::string_view what,
                                const std::string& where);

/// The columns that the farm system takes: numbers only, the first of them only.
VectorTable reduced_for(VectorTable table, const FarmProfile& profile);

/// A line of CSV for each column: name, short name, unit, meaning.
std::string field_dictionary(const std::vector<VectorColumn>& columns);

}  // namespace rayfield::formats
