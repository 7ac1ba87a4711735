#include "formats/gis/qml.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "formats/io/text_escape.h"

namespace rayfield::formats::qml {
namespace {

constexpr std::string_view kDoctype = "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n";
constexpr Rgba kOutlineGrey{70, 70, 70, 255};
/// Share of a scale at which a raster's colours are opaque.
constexpr double kOpaqueFrom = 0.1;
/// Share of a scale below which a panel holds nothing.
constexpr double kNothing = 0.01;

std::string color_text(const Rgba& color) { return fmt::format("{},{},{},{}", color.r, color.g, color.b, color.a); }

std::string option(std::string_view name, std::string_view value) {
  return fmt::format("<Option type=\"QString\" name=\"{}\" value=\"{}\"/>", name, xml_escape(value));
}

std::string symbol(std::string_view type, std::string_view name, std::string_view layer_class,
                   const std::vector<std::string>& properties) {
  std::string map;
  for (const std::string& property : properties) map += property;
  return fmt::format(
      "<symbol type=\"{}\" name=\"{}\" alpha=\"1\" clip_to_extent=\"1\" force_rhr=\"0\">"
      "<layer class=\"{}\" enabled=\"1\" locked=\"0\" pass=\"0\"><Option type=\"Map\">{}</Option></layer></symbol>\n",
      type, name, layer_class, map);
}

std::string fill_symbol(std::string_view name, const Rgba& fill, const Rgba& outline, double width_mm) {
  return symbol("fill", name, "SimpleFill",
                {option("color", color_text(fill)), option("style", fill.a == 0 ? "no" : "solid"),
                 option("outline_color", color_text(outline)), option("outline_style", "solid"),
                 option("outline_width", fmt::format("{}", width_mm)), option("outline_width_unit", "MM"),
                 option("joinstyle", "miter")});
}

std::string marker_symbol(std::string_view name, const Rgba& fill, double size_mm) {
  return symbol(
      "marker", name, "SimpleMarker",
      {option("name", "circle"), option("color", color_text(fill)), option("outline_color", color_text(kOutlineGrey)),
       option("outline_style", "solid"), option("outline_width", "0.1"), option("outline_width_unit", "MM"),
       option("size", fmt::format("{}", size_mm)), option("size_unit", "MM")});
}

std::string labeling(std::string_view expression, std::string_view placement, bool large_scales_only) {
  if (expression.empty()) return {};
  return fmt::format(
      "<labeling type=\"simple\"><settings calloutType=\"simple\">"
      "<text-style fieldName=\"{}\" isExpression=\"1\" fontFamily=\"Sans\" fontWeight=\"75\" fontSize=\"8\" "
      "fontSizeUnit=\"Point\" "
      "textColor=\"50,50,50,255\" textOpacity=\"1\" namedStyle=\"\">"
      "<text-buffer bufferDraw=\"1\" bufferSize=\"0.7\" bufferSizeUnits=\"MM\" bufferColor=\"255,255,255,220\" "
      "bufferOpacity=\"1\"/></text-style>"
      "<placement {}/>"
      "<rendering drawLabels=\"1\" obstacle=\"0\" scaleVisibility=\"{}\" scaleMin=\"0\" scaleMax=\"1500\"/>"
      "</settings></labeling>\n",
      xml_escape(expression), placement, large_scales_only ? 1 : 0);
}

std::string temporal(std::string_view date_column) {
  if (date_column.empty()) return {};
  return fmt::format(
      "<temporal enabled=\"1\" mode=\"1\" startField=\"{}\" endField=\"\" durationField=\"\" durationUnit=\"days\" "
      "fixedDuration=\"1\" accumulate=\"0\" limitMode=\"0\" startExpression=\"\" endExpression=\"\">"
      "<fixedRange><start></start><end></end></fixedRange></temporal>\n",
      xml_escape(date_column));
}

LayerStyle vector_style(std::string_view renderer, const std::string& labels, std::string_view date_column = {}) {
  return {fmt::format("{}{}{}<blendMode>0</blendMode>\n<layerOpacity>1</layerOpacity>\n", temporal(date_column),
                      renderer, labels),
          !labels.empty()};
}

LayerStyle single_symbol(const std::string& symbol_xml, const std::string& labels) {
  return vector_style(
      "<renderer-v2 type=\"singleSymbol\" enableorderby=\"0\" forceraster=\"0\" symbollevels=\"0\">\n<symbols>\n" +
          symbol_xml + "</symbols>\n</renderer-v2>\n",
      labels);
}

/// A class of a graduated style.
struct Class {
  double low = 0, high = 0;
  std::string label;
  Rgba color;
};

LayerStyle classes_style(const Graduated& options, const std::string& attribute, const std::vector<Class>& classes) {
  std::string ranges, symbols;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const Class& c = classes[i];
    ranges += fmt::format("<range symbol=\"{}\" lower=\"{:.9g}\" upper=\"{:.9g}\" label=\"{}\" render=\"true\"/>\n", i,
                          c.low, c.high, xml_escape(c.label));
    const std::string name = std::to_string(i);
    symbols += options.points ? marker_symbol(name, c.color, 1.4) : fill_symbol(name, c.color, kOutlineGrey, 0.2);
  }
  const std::string order =
      options.date_column.empty()
          ? std::string()
          : fmt::format("<orderby><orderByClause asc=\"1\" nullsFirst=\"0\">{}</orderByClause></orderby>\n",
                        xml_escape("\"" + options.date_column + "\""));
  const std::string renderer = fmt::format(
      "<renderer-v2 type=\"graduatedSymbol\" attr=\"{}\" graduatedMethod=\"GraduatedColor\" enableorderby=\"{}\" "
      "forceraster=\"0\" symbollevels=\"0\">\n<ranges>\n{}</ranges>\n<symbols>\n{}</symbols>\n{}</renderer-v2>\n",
      xml_escape(attribute), order.empty() ? 0 : 1, ranges, symbols, order);
  return vector_style(renderer, {}, options.date_column);
}

/// What a value of 0 is on a scale: nothing there, or a height like any other.
bool zero_is_nothing(const ColorScale& scale) { return scale.ramp != Ramp::terrain && scale.low <= 0; }

/// Opacity of the colour of a value.
int alpha_at(const ColorScale& scale, double value) {
  if (!zero_is_nothing(scale)) return 255;
  const double reach = std::max(scale.high, -scale.low) * kOpaqueFrom;
  return static_cast<int>(std::lround(255 * std::clamp(std::abs(value) / reach, 0.0, 1.0)));
}

}  // namespace

std::string document(const LayerStyle& style) {
  return fmt::format("{}<qgis version=\"3.22.0\" styleCategories=\"{}\" labelsEnabled=\"{}\">\n{}</qgis>\n", kDoctype,
                     style.categories, style.labelled ? 1 : 0, style.content);
}

LayerStyle raster_style(const ColorScale& scale, std::string_view unit) {
  std::string items, middle_stops;
  const double last = static_cast<double>(ramp_stops(scale.ramp).size() - 1);
  std::vector<double> stops;
  for (int i = 0; i <= static_cast<int>(last); ++i) stops.push_back(scale.low + i / last * (scale.high - scale.low));
  const auto color = [&scale](double value) {
    Rgba c = color_at(scale, value);
    c.a = static_cast<std::uint8_t>(alpha_at(scale, value));
    return c;
  };
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const Rgba c = color(stops[i]);
    items += fmt::format("<item value=\"{:.9g}\" label=\"{:.4g} {}\" color=\"{}\" alpha=\"{}\"/>\n", stops[i], stops[i],
                         xml_escape(pretty_unit(unit)), hex_text(c), c.a);
    if (i > 0 && i + 1 < stops.size()) {
      middle_stops += fmt::format("{}{:.6g};{}", middle_stops.empty() ? "" : ":",
                                  (stops[i] - scale.low) / (scale.high - scale.low), color_text(c));
    }
  }
  const std::string content = fmt::format(
      "<pipe>\n"
      "<rasterrenderer type=\"singlebandpseudocolor\" band=\"1\" opacity=\"1\" alphaBand=\"-1\" "
      "classificationMin=\"{:.9g}\" classificationMax=\"{:.9g}\" nodataColor=\"\">\n<rasterTransparency/>\n"
      "<minMaxOrigin><limits>None</limits><extent>WholeRaster</extent><statAccuracy>Estimated</statAccuracy>"
      "</minMaxOrigin>\n<rastershader>\n"
      "<colorrampshader colorRampType=\"INTERPOLATED\" classificationMode=\"1\" minimumValue=\"{:.9g}\" "
      "maximumValue=\"{:.9g}\" clip=\"0\" labelPrecision=\"2\">\n"
      "<colorramp type=\"gradient\" name=\"[source]\"><Option type=\"Map\">{}{}{}{}{}</Option></colorramp>\n"
      "{}</colorrampshader>\n</rastershader>\n</rasterrenderer>\n"
      "<brightnesscontrast brightness=\"0\" contrast=\"0\" gamma=\"1\"/>\n"
      "<rasterresampler maxOversampling=\"2\"/>\n</pipe>\n<blendMode>0</blendMode>\n",
      scale.low, scale.high, scale.low, scale.high, option("color1", color_text(color(stops.front()))),
      option("color2", color_text(color(stops.back()))), option("discrete", "0"), option("rampType", "gradient"),
      option("stops", middle_stops), items);
  return {content, false, "Symbology"};
}

LayerStyle graduated_style(const Graduated& options) {
  const ColorScale& scale = options.scale;
  const int count = scale.high - scale.low == 6 ? 12 : 10;
  const double width = (scale.high - scale.low) / count;
  const bool has_nothing = scale.low == 0;
  std::vector<Class> classes;
  // The outer classes are open, so that no value is left without a class.
  const double nothing = kNothing * scale.high;
  if (has_nothing) classes.push_back({-1e9, nothing, "nothing", {0, 0, 0, 0}});
  for (int i = 0; i < count; ++i) {
    const double low = scale.low + i * width, high = scale.low + (i + 1) * width;
    const bool first = i == 0, last = i + 1 == count;
    const std::string label = last ? fmt::format("over {:.4g}", low) : fmt::format("{:.4g} – {:.4g}", low, high);
    const double lower = !first ? low : has_nothing ? nothing : -1e9;
    classes.push_back({lower, last ? 1e9 : high, label, color_at(scale, first ? scale.low : low + width / 2)});
  }
  return classes_style(options, options.column, classes);
}

LayerStyle relative_style(const Graduated& options, std::string_view date_key) {
  const std::array<double, 8> limits = {-1e9, 50, 75, 90, 110, 125, 150, 1e9};
  std::vector<Class> classes;
  for (std::size_t i = 0; i + 1 < limits.size(); ++i) {
    const bool first = i == 0, last = i + 2 == limits.size();
    const std::string label = first  ? "under 50 %"
                              : last ? "over 150 %"
                                     : fmt::format("{} – {} %", limits[i], limits[i + 1]);
    classes.push_back({limits[i], limits[i + 1], label, color_at({0, 6, Ramp::change}, static_cast<double>(i))});
  }
  const std::string mean = fmt::format("mean(\"{}\", group_by:=\"{}\")", options.column, date_key);
  return classes_style(options, fmt::format("CASE WHEN {0} > 0 THEN 100 * \"{1}\" / {0} END", mean, options.column),
                       classes);
}

LayerStyle category_style(std::string_view column, std::span<const Category> categories) {
  std::string items, symbols;
  for (std::size_t i = 0; i < categories.size(); ++i) {
    const Category& category = categories[i];
    items += fmt::format("<category symbol=\"{}\" value=\"{}\" type=\"long\" label=\"{}\" render=\"true\"/>\n", i,
                         category.value, xml_escape(category.label));
    symbols += fill_symbol(std::to_string(i), category.fill, kOutlineGrey, 0.1);
  }
  return vector_style(
      fmt::format("<renderer-v2 type=\"categorizedSymbol\" attr=\"{}\" enableorderby=\"0\" forceraster=\"0\" "
                  "symbollevels=\"0\">\n<categories>\n{}</categories>\n<symbols>\n{}</symbols>\n</renderer-v2>\n",
                  xml_escape(column), items, symbols),
      {});
}

LayerStyle outline_style(const Rgba& color, std::string_view label_expression) {
  return single_symbol(fill_symbol("0", {0, 0, 0, 0}, color, 0.2),
                       labeling(label_expression, R"(placement="1" offsetUnits="MM")", true));
}

LayerStyle line_style(const Rgba& color, double width_mm, std::string_view label_expression) {
  return single_symbol(symbol("line", "0", "SimpleLine",
                              {option("line_color", color_text(color)), option("line_style", "solid"),
                               option("line_width", fmt::format("{}", width_mm)), option("line_width_unit", "MM"),
                               option("capstyle", "round"), option("joinstyle", "round")}),
                       labeling(label_expression,
                                R"(placement="1" geometryGeneratorEnabled="1" geometryGeneratorType="PointGeometry" )"
                                R"x(geometryGenerator="start_point(extend($geometry, 1.5, 0))")x",
                                false));
}

LayerStyle point_style(const Rgba& fill, double size_mm) {
  return single_symbol(marker_symbol("0", fill, size_mm), {});
}

}  // namespace rayfield::formats::qml
