#pragma once

#include <string>
#include <string_view>

#include "formats/gis/vector_table.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/farm_profile.h"

namespace rayfield::formats {

/// A table as zipped shapefile after the rules of a farm system. `stem`: of the files in the archive, made ASCII;
/// `date`: of the data, which the archive and its DBF file bear. Columns have their short names; text longer than 254
/// bytes is cut. Errors: usage (more columns or features than the system takes), internal, resources, bad_input.
Result<void> write_shapefile_zip(VectorTable table, const FarmProfile& profile, const std::string& stem,
                                 const std::string& date, const std::string& path, std::string_view what);

}  // namespace rayfield::formats
