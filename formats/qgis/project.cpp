#include "formats/qgis/project.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "formats/io/text_escape.h"

namespace rayfield::formats::qgis {
namespace {

constexpr std::string_view kNoCrs = "<spatialrefsys><wkt></wkt><authid></authid></spatialrefsys>";

/// What QGIS calls a kind of layer: its provider, and for features the geometry.
struct KindWords {
  std::string_view provider, geometry, wkb_type;
};

KindWords words(Layer::Kind kind) {
  switch (kind) {
    case Layer::Kind::polygon:
      return {"ogr", "Polygon", "Polygon"};
    case Layer::Kind::line:
      return {"ogr", "Line", "LineString"};
    case Layer::Kind::point:
      return {"ogr", "Point", "Point"};
    case Layer::Kind::table:
      return {"ogr", "No geometry", "NoGeometry"};
    case Layer::Kind::raster:
      break;
  }
  return {"gdal", "", ""};
}

std::string_view checked(bool shown) { return shown ? "Qt::Checked" : "Qt::Unchecked"; }

std::string crs_xml(const Project& project) {
  return fmt::format("<spatialrefsys><wkt>{}</wkt><authid>{}</authid></spatialrefsys>", xml_escape(project.crs_wkt),
                     xml_escape(project.crs_code));
}

std::string tree_layer_xml(const Layer& layer) {
  return fmt::format(
      "<layer-tree-layer id=\"{}\" name=\"{}\" providerKey=\"{}\" source=\"{}\" checked=\"{}\" expanded=\"0\" "
      "legend_exp=\"\"><customproperties><Option/></customproperties></layer-tree-layer>\n",
      xml_escape(layer.id), xml_escape(layer.name), words(layer.kind).provider, xml_escape(layer.source),
      checked(layer.shown));
}

std::string tree_group_xml(const Group& group) {
  std::string exclusive;
  if (group.one_at_a_time) {
    const auto shown = std::find_if(group.groups.begin(), group.groups.end(), [](const Group& g) { return g.shown; });
    exclusive = fmt::format(" mutually-exclusive=\"1\" mutually-exclusive-child=\"{}\"",
                            shown == group.groups.end() ? -1 : shown - group.groups.begin());
  }
  std::string content;
  for (const Layer& layer : group.layers) content += tree_layer_xml(layer);
  for (const Group& child : group.groups) content += tree_group_xml(child);
  return fmt::format(
      "<layer-tree-group name=\"{}\" checked=\"{}\" "
      "expanded=\"{}\"{}>\n<customproperties><Option/></customproperties>\n"
      "{}</layer-tree-group>\n",
      xml_escape(group.name), checked(group.shown), group.expanded ? 1 : 0, exclusive, content);
}

/// The styles to choose from; what the current one says stands in the layer itself.
std::string style_manager_xml(const Layer& layer) {
  if (layer.styles.empty()) return {};
  const std::string current = xml_escape(layer.styles.front().name);
  std::string others;
  for (std::size_t i = 1; i < layer.styles.size(); ++i) {
    const qml::LayerStyle& style = layer.styles[i].style;
    others += fmt::format(
        "<map-layer-style name=\"{}\">\n<qgis version=\"3.22.0\" styleCategories=\"{}\" labelsEnabled=\"{}\">\n"
        "{}</qgis>\n</map-layer-style>\n",
        xml_escape(layer.styles[i].name), style.categories, style.labelled ? 1 : 0, style.content);
  }
  return fmt::format(
      "<map-layer-style-manager current=\"{0}\">\n<map-layer-style name=\"{0}\"/>\n{1}</map-layer-style-manager>\n",
      current, others);
}

std::string time_xml(const Layer& layer) {
  if (layer.range.begin.empty()) return {};
  const std::string_view of_kind = layer.kind == Layer::Kind::raster
                                       ? "fetchMode=\"0\""
                                       : "startField=\"\" endField=\"\" durationField=\"\" durationUnit=\"days\" "
                                         "fixedDuration=\"0\" accumulate=\"0\" limitMode=\"0\" startExpression=\"\" "
                                         "endExpression=\"\"";
  return fmt::format(
      "<temporal enabled=\"1\" mode=\"0\" {}><fixedRange><start>{}</start><end>{}</end></fixedRange></temporal>\n",
      of_kind, layer.range.begin, layer.range.end);
}

std::string layer_xml(const Layer& layer, const std::string& crs) {
  const KindWords kind = words(layer.kind);
  const bool raster = layer.kind == Layer::Kind::raster;
  const std::string type =
      raster ? "type=\"raster\""
             : fmt::format(
                   "type=\"vector\" geometry=\"{}\" wkbType=\"{}\" readOnly=\"1\" "
                   "labelsEnabled=\"{}\"",
                   kind.geometry, kind.wkb_type, !layer.styles.empty() && layer.styles.front().style.labelled ? 1 : 0);
  return fmt::format(
      "<maplayer {} styleCategories=\"AllStyleCategories\" hasScaleBasedVisibilityFlag=\"0\">\n<id>{}</id>\n"
      "<datasource>{}</datasource>\n<layername>{}</layername>\n<srs>{}</srs>\n"
      "<provider{}>{}</provider>\n{}{}{}</maplayer>\n",
      type, xml_escape(layer.id), xml_escape(layer.source), xml_escape(layer.name),
      layer.kind == Layer::Kind::table ? kNoCrs : std::string_view(crs), raster ? "" : " encoding=\"UTF-8\"",
      kind.provider, style_manager_xml(layer), time_xml(layer),
      layer.styles.empty() ? std::string() : layer.styles.front().style.content);
}

std::vector<const Layer*> layers_of(const std::vector<Group>& groups) {
  std::vector<const Layer*> all;
  for (const Group& group : groups) {
    for (const Layer& layer : group.layers) all.push_back(&layer);
    for (const Layer* layer : layers_of(group.groups)) all.push_back(layer);
  }
  return all;
}

std::string relations_xml(const Project& project) {
  std::string text;
  for (const Relation& r : project.relations)
    text += fmt::format(
        "<relation id=\"{}\" name=\"{}\" referencedLayer=\"{}\" referencingLayer=\"{}\" strength=\"Association\">"
        "<fieldRef referencedField=\"{}\" referencingField=\"{}\"/></relation>\n",
        xml_escape(r.id), xml_escape(r.name), xml_escape(r.parent), xml_escape(r.child), xml_escape(r.key),
        xml_escape(r.key));
  return text;
}

/// The temporal controller is switched on (mode 1: animated) and steps from range to range of the layers ("xxx" stands
/// for their own, irregular steps). QGIS keeps no current step, but begins with the one that holds StartDateTime.
std::string controller_xml(const Project& project) {
  if (project.time.begin.empty()) return {};
  return fmt::format(
      "<TemporalControllerWidget><NavigationMode type=\"int\">1</NavigationMode>"
      "<StartDateTime type=\"QString\">{}</StartDateTime><EndDateTime type=\"QString\">{}</EndDateTime>"
      "</TemporalControllerWidget>",
      project.first_time.begin, project.first_time.end);
}

std::string time_settings_xml(const Project& project) {
  if (project.time.begin.empty()) return {};
  return fmt::format(
      "<ProjectTimeSettings timeStepUnit=\"xxx\" timeStep=\"1\" frameRate=\"1\" cumulativeTemporalRange=\"0\">"
      "<TemporalRange><start>{}</start><end>{}</end></TemporalRange></ProjectTimeSettings>\n",
      project.time.begin, project.time.end);
}

std::string view_xml(const Project& project, const std::string& crs) {
  if (project.extent.isEmpty()) return {};
  return fmt::format(
      "<ProjectViewSettings UseProjectScales=\"0\" rotation=\"0\"><Scales/>"
      "<DefaultViewExtent xmin=\"{:.3f}\" ymin=\"{:.3f}\" xmax=\"{:.3f}\" ymax=\"{:.3f}\">{}</DefaultViewExtent>"
      "</ProjectViewSettings>\n",
      project.extent.min().x(), project.extent.min().y(), project.extent.max().x(), project.extent.max().y(), crs);
}

}  // namespace

std::string project_xml(const Project& project) {
  const std::string crs = crs_xml(project);
  std::string tree, layers;
  for (const Group& group : project.groups) tree += tree_group_xml(group);
  for (const Layer* layer : layers_of(project.groups)) layers += layer_xml(*layer, crs);
  return fmt::format(
      "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"
      "<qgis projectname=\"{0}\" version=\"3.22.0\">\n<homePath path=\"\"/>\n<title>{0}</title>\n"
      "<projectCrs>{1}</projectCrs>\n"
      "<layer-tree-group>\n<customproperties><Option/></customproperties>\n{2}</layer-tree-group>\n"
      "<relations>\n{3}</relations>\n<projectlayers>\n{4}</projectlayers>\n"
      "<properties><Paths><Absolute type=\"bool\">false</Absolute></Paths>"
      "<SpatialRefSys><ProjectionsEnabled type=\"int\">1</ProjectionsEnabled></SpatialRefSys>{5}</properties>\n"
      "{6}{7}</qgis>\n",
      xml_escape(project.title), crs, tree, relations_xml(project), layers, controller_xml(project),
      view_xml(project, crs), time_settings_xml(project));
}

}  // namespace rayfield::formats::qgis
