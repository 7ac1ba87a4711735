#pragma once

#include <span>
#include <string>
#include <string_view>

#include "formats/picture/color.h"

/// Styles of QGIS layers (read by QGIS 3.22 and later), as text without anything time-dependent. 0 and NULL are
/// transparent, so that imagery under a map stays visible where there is nothing.
namespace rayfield::formats::qml {

/// How a layer is drawn. A style file holds it in a document of its own, a project in the layer's element.
struct LayerStyle {
  std::string content;  ///< XML elements
  bool labelled = false;
  std::string_view categories = "AllStyleCategories";  ///< what it speaks of
};

/// The text of a `.qml` file, of a row of `layer_styles`, and of a further style within a project.
std::string document(const LayerStyle& style);

/// A single-band raster in the colours of `scale`, interpolated; NaN is transparent. So is 0 on scales of what may be
/// absent (not of the ground): colours become opaque by a tenth of the scale.
LayerStyle raster_style(const ColorScale& scale, std::string_view unit);

/// Polygons or points in classes of a number; NULL is not drawn. With `date_column` the layer follows QGIS's temporal
/// controller, and later dates are drawn over earlier ones.
struct Graduated {
  std::string column;
  ColorScale scale;
  bool points = false;
  std::string date_column = {};  ///< empty: not temporal
};
/// Equal intervals of `scale` (ten, or steps of 0.5 where the scale ends at 6), and before them a class without fill
/// for what is nothing (less than a hundredth of the scale).
LayerStyle graduated_style(const Graduated& options);

/// A number in per cent of its mean on the same date, in seven classes around 90 … 110 %: which places are weak and
/// which are strong on a date, whatever the season. `options.scale` is not used; nothing is drawn where the mean is not
/// above 0. `date_key`: the column that distinguishes dates.
LayerStyle relative_style(const Graduated& options, std::string_view date_key);

/// Polygons in one colour for each whole number of `column`.
struct Category {
  int value = 0;
  std::string label;
  Rgba fill;
};
LayerStyle category_style(std::string_view column, std::span<const Category> categories);

/// Thin outlines without fill, labelled with an expression (empty: no labels) where the map is larger than 1 : 1500.
LayerStyle outline_style(const Rgba& color, std::string_view label_expression);
/// Lines, labelled at any scale, 1.5 m before their start.
LayerStyle line_style(const Rgba& color, double width_mm, std::string_view label_expression);
/// Small discs.
LayerStyle point_style(const Rgba& fill, double size_mm);

}  // namespace rayfield::formats::qml
