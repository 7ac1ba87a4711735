#pragma once

#include <span>
#include <string>

#include "rayfield/core/result.h"
#include "rayfield/formats/picture.h"

namespace rayfield::formats {

/// How several sections share a sheet.
enum class SectionOrder {
  one_after_the_other,  ///< each with its own length, side by side where they fit
  stacked               ///< all over the same length, under each other: one row on several dates
};

/// Draws sections and writes the picture. The options have been checked. Errors: as write_section_picture().
Result<void> draw_sections(std::span<const LabelledSection> sections, SectionOrder order, const std::string& path,
                           const PictureOptions& options);

}  // namespace rayfield::formats
