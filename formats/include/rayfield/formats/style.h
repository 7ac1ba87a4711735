#pragma once

#include <cstdint>

/// How products are drawn: colours, lines and text. Every map of one product uses one fixed colour scale, so that two
/// dates can be compared by eye.
namespace rayfield::formats {

/// An sRGB colour; alpha 255 is opaque.
struct Rgba {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;
  bool operator==(const Rgba&) const = default;
};

/// Colour ramps as 11 equidistant sRGB stops, interpolated linearly in sRGB (as QGIS does). Lightness (CIE L*) is
/// monotonic (from the middle on, for changes) and equal steps in value are equal colour differences (CIE76) within 10
/// %, so no edge is invented and a grey print still orders the values.
enum class Ramp {
  canopy,  ///< cream → green → deep blue. Nothing is light; the order low-green-blue echoes the paper's figures
           ///< (red-green-blue) without its unequal steps and its red-green confusion
  height,  ///< cream → amber → brown
  uncertainty,  ///< cream → rose → purple
  terrain,      ///< dark green (low) → sand (high)
  change,  ///< brown (loss) → almost white → teal (gain): lightness falls from the middle to both ends, and the two
           ///< sides differ for people who cannot tell red from green
};

/// A value range and the ramp over it. Values outside take the end colours.
struct ColorScale {
  double low = 0, high = 1;
  Ramp ramp = Ramp::canopy;
};

enum class Align { start, middle, end };

struct TextStyle {
  double size_px = 20;
  Rgba color{40, 40, 40, 255};
  bool bold = false;
  Align horizontal = Align::start;
  Align vertical = Align::end;  ///< start: position is the top of capital letters, end: the baseline
  double rotation_rad = 0;      ///< counter-clockwise
  double halo_px = 0;           ///< white rim, for text over a map
};

struct StrokeStyle {
  Rgba color{40, 40, 40, 255};
  double width_px = 1;
  double dash_px = 0;  ///< 0: solid
};

}  // namespace rayfield::formats
