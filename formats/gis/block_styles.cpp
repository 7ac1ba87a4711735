#include "formats/gis/block_styles.h"

namespace rayfield::formats {
namespace {

constexpr Rgba kRowGrey{110, 110, 110, 255}, kPanelGrey{90, 90, 90, 255}, kPostBrown{120, 80, 50, 255};
constexpr const char* kColumn = "leaf_area_per_m";

}  // namespace

qml::LayerStyle row_style() { return qml::line_style(kRowGrey, 0.15, "\"row_number\""); }
qml::LayerStyle panel_style() {
  return qml::outline_style(kPanelGrey, "concat(\"row_number\", '/', \"panel_number\")");
}
qml::LayerStyle post_style() { return qml::point_style(kPostBrown, 1.2); }

qml::LayerStyle panel_value_style(const ColorScale& scale, bool points, const std::string& date_column) {
  return qml::graduated_style({kColumn, scale, points, date_column});
}

qml::LayerStyle panel_relative_style(bool points, const std::string& date_column) {
  return qml::relative_style({kColumn, {}, points, date_column}, "scan_id");
}

}  // namespace rayfield::formats
