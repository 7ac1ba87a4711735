#pragma once

/// picture: maps and vertical sections as PNG, and the colour scales of all products.

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "formats/picture/canvas.h"
#include "formats/picture/color.h"
#include "rayfield/formats/picture.h"

/// The elements around maps and sections: titles, colour bars, scale bar, north arrow. `unit_px` is the size of one
/// design pixel: pictures are designed 1600 px wide.
namespace rayfield::formats::elements {

inline constexpr Rgba kInk{38, 42, 46, 255}, kGrey{110, 116, 122, 255}, kFrameGrey{150, 156, 162, 255};
inline constexpr std::string_view kPictureWhat = "cannot write picture";

/// Title and subtitle from the top left corner; returns the y below them.
double header(Canvas& canvas, const PictureOptions& options, double margin_px, double unit_px);
/// The same height without drawing.
double header_height(const PictureOptions& options, double margin_px, double unit_px);

/// Breaks text at spaces into lines that fit; a single longer word keeps its line.
std::vector<std::string> wrap(const Canvas& canvas, std::string_view text, const TextStyle& style, double width_px);

/// What the numbers of a product mean, without unit: "plan_density" → "Canopy density".
std::string product_title(std::string_view product);

/// Vertical bar, low value at the bottom, ticks on its right; pointed at an end that values go beyond.
struct BarEnds {
  bool below = false, above = false;
};
void vertical_bar(Canvas& canvas, const ColorScale& scale, const Eigen::Vector2d& corner, const Eigen::Vector2d& size,
                  const BarEnds& ends, double unit_px);
/// Horizontal bar, ticks below it.
void horizontal_bar(Canvas& canvas, const ColorScale& scale, const Eigen::Vector2d& corner, const Eigen::Vector2d& size,
                    const BarEnds& ends, double unit_px);

/// A hatched box and "not scanned"; returns the width used.
double not_scanned_key(Canvas& canvas, const Eigen::Vector2d& corner, double unit_px);

/// A bar of 1, 2 or 5 × 10ⁿ metres, at most `max_px` long; `corner`: bottom left.
void scale_bar(Canvas& canvas, const Eigen::Vector2d& corner, double px_per_m, double max_px, double unit_px);
/// An arrow pointing up (grid north), `height_px` high with its letter; `foot`: bottom middle.
void north_arrow(Canvas& canvas, const Eigen::Vector2d& foot, double height_px);

void frame(Canvas& canvas, const Eigen::Vector2d& corner, const Eigen::Vector2d& size, double unit_px);

}  // namespace rayfield::formats::elements
