#pragma once

#include <span>
#include <string>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/core/season_products.h"
#include "rayfield/formats/picture.h"

namespace rayfield::formats {

/// Draws and writes it. The options have been checked. Errors: as write_season_chart().
Result<void> draw_season(const BlockProducts& block, std::span<const SeasonValue> values, std::span<const int> rows,
                         const std::string& path, const PictureOptions& options);

}  // namespace rayfield::formats
