#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "formats/gis/vector_table.h"
#include "rayfield/core/products.h"
#include "rayfield/core/result.h"

namespace rayfield::formats {

/// Columns of the panels of one date, as all exchange formats have them.
std::vector<VectorColumn> panel_columns();

/// The panels of one scan in longitude and latitude, coloured by leaf area per metre. A panel without a value on that
/// scan has only its own columns. Errors: usage (CRS, `scan_index` beyond the scans), internal (coordinates).
Result<VectorTable> panel_table(const BlockProducts& block, std::size_t scan_index, std::string_view what,
                                const std::string& where);

/// The columns that are numbers and no others.
VectorTable numbers_only(VectorTable table);

/// A line of CSV for each column: name, short name, unit, meaning.
std::string field_dictionary(const std::vector<VectorColumn>& columns);

}  // namespace rayfield::formats
