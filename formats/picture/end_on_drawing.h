#pragma once

#include <span>
#include <string>

#include "rayfield/core/result.h"
#include "rayfield/formats/picture.h"

namespace rayfield::formats {

/// Draws end-on sections in a grid and writes the picture. The options have been checked. Errors: as
/// write_end_on_picture().
Result<void> draw_end_on(std::span<const LabelledSection> rows, const std::string& path, const PictureOptions& options);

}  // namespace rayfield::formats
