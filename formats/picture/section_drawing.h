#pragma once

#include <limits>
#include <span>
#include <string>

#include "formats/picture/picture_elements.h"
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

/// Of all values of a sheet; NaN, NaN without any.
struct SectionRange {
  double low = std::numeric_limits<double>::quiet_NaN(), high = low;
  elements::BarEnds beyond(const ColorScale& scale) const { return {low<scale.low, high> scale.high}; }
};
/// Errors: usage (no section), internal (a section without cells or of inconsistent size).
Result<SectionRange> check_sections(std::span<const LabelledSection> sections, const std::string& path);

/// A sheet of sections, px.
struct SectionSheet {
  int width_px = 0;
  double margin = 0, unit = 1;
  elements::BarEnds ends;
};
/// Colour bar at the top right, its meaning above it, "not scanned" at its left.
void draw_section_legend(Canvas& canvas, const SectionSheet& sheet, const SectionProduct& section,
                         const PictureOptions& options, const ColorScale& scale);

}  // namespace rayfield::formats
