#include "formats/gis/qml.h"

#include <fmt/format.h>

#include <vector>

#include "formats/io/text_escape.h"

namespace rayfield::formats::qml {
namespace {

constexpr std::string_view kDoctype = "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n";
constexpr Rgba kOutlineGrey{70, 70, 70, 255};

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

std::string labeling(std::string_view expression) {
  if (expression.empty()) return {};
  return fmt::format(
      "<labeling type=\"simple\"><settings calloutType=\"simple\">"
      "<text-style fieldName=\"{}\" isExpression=\"1\" fontFamily=\"Sans\" fontSize=\"8\" fontSizeUnit=\"Point\" "
      "textColor=\"50,50,50,255\" textOpacity=\"1\" namedStyle=\"\">"
      "<text-buffer bufferDraw=\"1\" bufferSize=\"0.7\" bufferSizeUnits=\"MM\" bufferColor=\"255,255,255,220\" "
      "bufferOpacity=\"1\"/></text-style>"
      "<rendering drawLabels=\"1\" obstacle=\"0\"/></settings></labeling>\n",
      xml_escape(expression));
}

std::string temporal(std::string_view date_column) {
  if (date_column.empty()) return {};
  return fmt::format(
      "<temporal enabled=\"1\" mode=\"1\" startField=\"{}\" endField=\"\" durationField=\"\" durationUnit=\"days\" "
      "fixedDuration=\"1\" accumulate=\"0\" limitMode=\"0\" startExpression=\"\" endExpression=\"\">"
      "<fixedRange><start></start><end></end></fixedRange></temporal>\n",
      xml_escape(date_column));
}

std::string vector_document(std::string_view renderer, std::string_view label_expression,
                            std::string_view date_column) {
  return fmt::format(
      "{}<qgis version=\"3.22.0\" styleCategories=\"AllStyleCategories\" labelsEnabled=\"{}\">\n"
      "{}{}{}<blendMode>0</blendMode>\n<layerOpacity>1</layerOpacity>\n</qgis>\n",
      kDoctype, label_expression.empty() ? 0 : 1, temporal(date_column), renderer, labeling(label_expression));
}

std::string single_symbol(const std::string& symbol_xml, std::string_view label_expression) {
  return vector_document(
      "<renderer-v2 type=\"singleSymbol\" enableorderby=\"0\" forceraster=\"0\" symbollevels=\"0\">\n<symbols>\n" +
          symbol_xml + "</symbols>\n</renderer-v2>\n",
      label_expression, {});
}

}  // namespace

std::string raster_style(const ColorScale& scale, std::string_view unit) {
  const std::span<const Rgba> stops = ramp_stops(scale.ramp);
  const double last = static_cast<double>(stops.size() - 1);
  std::string items, middle_stops;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const double position = static_cast<double>(i) / last;
    const double value = scale.low + position * (scale.high - scale.low);
    items += fmt::format("<item value=\"{:.9g}\" label=\"{:.4g} {}\" color=\"{}\" alpha=\"255\"/>\n", value, value,
                         xml_escape(pretty_unit(unit)), hex_text(stops[i]));
    if (i > 0 && i + 1 < stops.size()) {
      middle_stops += fmt::format("{}{:.6g};{}", middle_stops.empty() ? "" : ":", position, color_text(stops[i]));
    }
  }
  return fmt::format(
      "{}<qgis version=\"3.22.0\" styleCategories=\"Symbology\">\n<pipe>\n"
      "<rasterrenderer type=\"singlebandpseudocolor\" band=\"1\" opacity=\"1\" alphaBand=\"-1\" "
      "classificationMin=\"{:.9g}\" classificationMax=\"{:.9g}\" nodataColor=\"\">\n<rasterTransparency/>\n"
      "<minMaxOrigin><limits>None</limits><extent>WholeRaster</extent><statAccuracy>Estimated</statAccuracy>"
      "</minMaxOrigin>\n<rastershader>\n"
      "<colorrampshader colorRampType=\"INTERPOLATED\" classificationMode=\"1\" minimumValue=\"{:.9g}\" "
      "maximumValue=\"{:.9g}\" clip=\"0\" labelPrecision=\"2\">\n"
      "<colorramp type=\"gradient\" name=\"[source]\"><Option type=\"Map\">{}{}{}{}{}</Option></colorramp>\n"
      "{}</colorrampshader>\n</rastershader>\n</rasterrenderer>\n"
      "<brightnesscontrast brightness=\"0\" contrast=\"0\" gamma=\"1\"/>\n"
      "<rasterresampler maxOversampling=\"2\"/>\n</pipe>\n<blendMode>0</blendMode>\n</qgis>\n",
      kDoctype, scale.low, scale.high, scale.low, scale.high, option("color1", color_text(stops.front())),
      option("color2", color_text(stops.back())), option("discrete", "0"), option("rampType", "gradient"),
      option("stops", middle_stops), items);
}

std::string graduated_style(const Graduated& options) {
  std::string ranges, symbols;
  const double width = (options.scale.high - options.scale.low) / options.classes;
  for (int i = 0; i < options.classes; ++i) {
    const double low = options.scale.low + i * width, high = options.scale.low + (i + 1) * width;
    const bool first = i == 0, last = i + 1 == options.classes;
    // The outer classes are open, so that no value is left without a colour.
    const std::string label = last ? fmt::format("over {:.4g}", low) : fmt::format("{:.4g} – {:.4g}", low, high);
    ranges += fmt::format("<range symbol=\"{}\" lower=\"{:.9g}\" upper=\"{:.9g}\" label=\"{}\" render=\"true\"/>\n", i,
                          first ? -1e9 : low, last ? 1e9 : high, xml_escape(label));
    const Rgba color = color_at(options.scale, first ? options.scale.low : low + width / 2);
    const std::string name = std::to_string(i);
    symbols += options.points ? marker_symbol(name, color, 1.4) : fill_symbol(name, color, kOutlineGrey, 0.1);
  }
  const std::string order =
      options.date_column.empty()
          ? std::string()
          : fmt::format("<orderby><orderByClause asc=\"1\" nullsFirst=\"0\">{}</orderByClause></orderby>\n",
                        xml_escape("\"" + options.date_column + "\""));
  const std::string renderer = fmt::format(
      "<renderer-v2 type=\"graduatedSymbol\" attr=\"{}\" graduatedMethod=\"GraduatedColor\" enableorderby=\"{}\" "
      "forceraster=\"0\" symbollevels=\"0\">\n<ranges>\n{}</ranges>\n<symbols>\n{}</symbols>\n{}</renderer-v2>\n",
      xml_escape(options.column), order.empty() ? 0 : 1, ranges, symbols, order);
  return vector_document(renderer, {}, options.date_column);
}

std::string category_style(std::string_view column, std::span<const Category> categories) {
  std::string items, symbols;
  for (std::size_t i = 0; i < categories.size(); ++i) {
    const Category& category = categories[i];
    items += fmt::format("<category symbol=\"{}\" value=\"{}\" type=\"long\" label=\"{}\" render=\"true\"/>\n", i,
                         category.value, xml_escape(category.label));
    symbols += fill_symbol(std::to_string(i), category.fill, kOutlineGrey, 0.1);
  }
  return vector_document(
      fmt::format("<renderer-v2 type=\"categorizedSymbol\" attr=\"{}\" enableorderby=\"0\" forceraster=\"0\" "
                  "symbollevels=\"0\">\n<categories>\n{}</categories>\n<symbols>\n{}</symbols>\n</renderer-v2>\n",
                  xml_escape(column), items, symbols),
      {}, {});
}

std::string outline_style(const Rgba& color, std::string_view label_expression) {
  return single_symbol(fill_symbol("0", {0, 0, 0, 0}, color, 0.2), label_expression);
}

std::string line_style(const Rgba& color, double width_mm, std::string_view label_expression) {
  return single_symbol(symbol("line", "0", "SimpleLine",
                              {option("line_color", color_text(color)), option("line_style", "solid"),
                               option("line_width", fmt::format("{}", width_mm)), option("line_width_unit", "MM"),
                               option("capstyle", "round"), option("joinstyle", "round")}),
                       label_expression);
}

std::string point_style(const Rgba& fill, double size_mm) {
  return single_symbol(marker_symbol("0", fill, size_mm), {});
}

}  // namespace rayfield::formats::qml
