#pragma once

#include <span>
#include <string>

#include "rayfield/core/result.h"
#include "rayfield/formats/picture.h"

namespace rayfield::formats {

/// Draws sections under each other and writes the picture. The options have been checked. Errors: as
/// write_section_picture().
Result<void> draw_sections(std::span<const LabelledSection> sections, const std::string& path,
                           const PictureOptions& options);

}  // namespace rayfield::formats
