#pragma once

#include <string>

#include "rayfield/core/result.h"
#include "rayfield/core/season_products.h"
#include "rayfield/formats/picture.h"

namespace rayfield::formats {

/// Draws and writes it. The options have been checked. Errors: as write_scatter_chart().
Result<void> draw_scatter(const DateComparison& comparison, const std::string& path, const PictureOptions& options);

}  // namespace rayfield::formats
