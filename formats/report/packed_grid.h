#pragma once

#include <string>

#include "rayfield/core/grid2.h"
#include "rayfield/core/result.h"

/// report: one block as one HTML document: its data packed, its text, its page.
namespace rayfield::formats {

/// Levels of a packed grid: 0 stands for NaN, 1 for 0 and below, kPackedLevels for `high` and above, equal steps
/// between. A step of 1/47 of the scale is less than a colour bar shows.
inline constexpr int kPackedLevels = 48;

/// The level of a value.
int packed_level(float value, double high);

/// One byte per cell, north-most row first (as pictures are drawn), zlib (RFC 1950), base64. Errors: resources.
Result<std::string> packed_grid(const Grid2<float>& grid, double high);

}  // namespace rayfield::formats
