#pragma once

#include <string>

#include "rayfield/core/result.h"

namespace rayfield::formats::gpkg {

/// carry_over() of geopackage.h: by SQL, table for table, with the old file attached to the new one.
Result<void> carry_additions(const std::string& from, const std::string& to);

}  // namespace rayfield::formats::gpkg
