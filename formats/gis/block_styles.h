#pragma once

#include <string>

#include "formats/gis/qml.h"

/// How the layers of a block look, in `layer_styles` and in projects alike.
namespace rayfield::formats {

inline constexpr const char* kLeafAreaWords = "leaf area per metre of row, m²/m";
/// Names of styles: by the value, on one scale for all dates; and by how it compares with the rest of the block.
inline constexpr const char* kAbsoluteStyle = "one scale for all dates";
inline constexpr const char* kRelativeStyle = "per cent of the date's mean";

qml::LayerStyle row_style();
qml::LayerStyle panel_style();
qml::LayerStyle post_style();

/// Leaf area per metre of row, of panels or (as points) of half metres. `date_column`: see qml::Graduated.
qml::LayerStyle panel_value_style(const ColorScale& scale, bool points, const std::string& date_column);
qml::LayerStyle panel_relative_style(bool points, const std::string& date_column);

}  // namespace rayfield::formats
