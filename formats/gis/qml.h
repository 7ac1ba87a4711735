#pragma once

#include <span>
#include <string>
#include <string_view>

#include "formats/picture/color.h"

/// QGIS layer styles (QML, read by QGIS 3.22 and later), as text without anything time-dependent.
namespace rayfield::formats::qml {

/// A single-band raster in the colours of `scale`, interpolated; NaN stays transparent.
std::string raster_style(const ColorScale& scale, std::string_view unit);

/// Polygons or points in classes of `column`, equal intervals of `scale`; NULL is not drawn. With `date_column` the
/// layer follows QGIS's temporal controller, and later dates are drawn over earlier ones.
struct Graduated {
  std::string column, label;
  ColorScale scale;
  int classes = 12;
  bool points = false;
  std::string date_column;  ///< empty: not temporal
};
std::string graduated_style(const Graduated& options);

/// Polygons in one colour for each whole number of `column`.
struct Category {
  int value = 0;
  std::string label;
  Rgba fill;
};
std::string category_style(std::string_view column, std::span<const Category> categories);

/// Thin outlines without fill, labelled with an expression (empty: no labels).
std::string outline_style(const Rgba& color, std::string_view label_expression);
/// Lines, labelled likewise.
std::string line_style(const Rgba& color, double width_mm, std::string_view label_expression);
/// Small discs.
std::string point_style(const Rgba& fill, double size_mm);

}  // namespace rayfield::formats::qml
