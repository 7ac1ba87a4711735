#pragma once

#include <string>

#include "rayfield/core/result.h"
#include "rayfield/formats/chart.h"

namespace rayfield::formats {

/// Draws and writes it. The options have been checked. Errors: as write_series_chart().
Result<void> draw_series(const SeriesChart& chart, const std::string& path, const PictureOptions& options);

}  // namespace rayfield::formats
