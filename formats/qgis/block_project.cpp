#include "formats/qgis/block_project.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "formats/gis/block_styles.h"
#include "formats/io/text_escape.h"

namespace rayfield::formats::qgis {
namespace {

using Kind = Layer::Kind;

/// Products by name, and what a layer of them is called.
constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kMapNames = {
    {{"plan_density", "canopy density"},
     {"leaf_density", "leaf density"},
     {"canopy_height", "canopy height"},
     {"plan_density_se", "standard error of the canopy density"},
     {"ground", "height of the ground"}}};

/// QGIS gives layers whose ids are short new ones, and then no group and no relation finds them.
std::string id(std::string_view layer) { return fmt::format("rayfield_{}", layer); }
std::string id(std::string_view layer, std::size_t scan) { return fmt::format("rayfield_{}_{}", layer, scan + 1); }

/// Makes the layers of one block.
class BlockLayers {
 public:
  BlockLayers(const BlockProducts& block, const ColorScale& panel_scale, std::span<const ProjectMap> maps,
              std::string file_name)
      : block_(block), panel_scale_(panel_scale), maps_(maps), file_name_(std::move(file_name)) {}

  Group outlines() const {
    Group group{"Rows, panels and posts", {}};
    group.layers = {
        {id("vine_row"), "rows", Kind::line, table("vine_row"), {{"numbers", row_style()}}},
        {id("post"), "posts", Kind::point, table("post"), {{"posts", post_style()}}},
        {id("panel"), "panels, with their numbers", Kind::polygon, table("panel"), {{"numbers", panel_style()}}}};
    for (Layer& layer : group.layers) layer.shown = true;
    return group;
  }

  Group date(std::size_t scan, bool shown) const {
    Group group{title(scan), {}};
    group.shown = group.expanded = shown;
    group.layers.push_back(panels(scan, "panels"));
    group.layers.back().shown = true;
    Layer metres = values(scan, "metres", "row_metre", "half metres of row", true);
    metres.kind = Kind::point;
    group.layers.push_back(std::move(metres));
    for (const auto& [product, name] : kMapNames)
      for (const ProjectMap& map : maps_)
        if (map.product == product && map.scan_id == scan_of(scan).scan_id) {
          group.layers.push_back(raster(scan, map, product, name));
        }
    return group;
  }

  Group all_panels() const {
    Group group = temporal_group("All dates: panels (temporal controller)");
    for (std::size_t i = block_.scans.size(); i-- > 0;) add_timed(group, i, panels(i, "season_panels"));
    return group;
  }

  Group all_maps() const {
    Group group = temporal_group("All dates: canopy density (temporal controller)");
    for (std::size_t i = block_.scans.size(); i-- > 0;)
      for (const ProjectMap& map : maps_)
        if (map.product == "plan_density" && map.scan_id == scan_of(i).scan_id)
          add_timed(group, i, raster(i, map, "season_plan_density", ""));
    return group;
  }

  Group tables() const {
    Group group{"Tables", {}};
    group.expanded = false;
    for (const auto& [name, words] : {std::pair{"panel_value", "values of panels, one line per date"},
                                      std::pair{"scan", "scans (dates)"}, std::pair{"block", "block"}})
      group.layers.push_back({id(name), words, Kind::table, table(name), {}});
    return group;
  }

  TimeRange day(std::size_t scan) const {
    const std::string& date = scan_of(scan).scan_date;
    return {date + "T00:00:00Z", date + "T23:59:59Z"};
  }

 private:
  const ScanProduct& scan_of(std::size_t scan) const { return block_.scans[scan].scan; }

  std::string title(std::size_t scan) const {
    const ScanProduct& of = scan_of(scan);
    return of.name.empty() ? of.scan_id : of.scan_id + " " + of.name;
  }

  std::string table(std::string_view name) const { return fmt::format("./{}|layername={}", file_name_, name); }

  // Values of one scan, with absolute classes and with classes relative to the date's mean.
  Layer values(std::size_t scan, std::string_view layer, std::string_view of, std::string_view name,
               bool points) const {
    const std::string source = fmt::format("{}|subset=\"scan_id\" = {}", table(of), sql_literal(scan_of(scan).scan_id));
    return {id(layer, scan),
            fmt::format("{}: {}", name, kLeafAreaWords),
            Kind::polygon,
            source,
            {{kAbsoluteStyle, panel_value_style(panel_scale_, points, "")},
             {kRelativeStyle, panel_relative_style(points, "")}}};
  }
  Layer panels(std::size_t scan, std::string_view layer) const {
    return values(scan, layer, "panel_by_date", "panels", false);
  }

  Layer raster(std::size_t scan, const ProjectMap& map, std::string_view layer, std::string_view name) const {
    return {id(layer, scan),
            fmt::format("{}, {}", name, pretty_unit(map.unit)),
            Kind::raster,
            "./" + map.file_name,
            {{kAbsoluteStyle, qml::raster_style(map.scale, map.unit)}}};
  }

  static Group temporal_group(const char* name) {
    Group group{name, {}};
    group.shown = group.expanded = false;
    return group;
  }
  void add_timed(Group& group, std::size_t scan, Layer layer) const {
    layer.name = title(scan);
    layer.range = day(scan);
    layer.shown = true;
    group.layers.push_back(std::move(layer));
  }

  const BlockProducts& block_;
  const ColorScale& panel_scale_;
  std::span<const ProjectMap> maps_;
  std::string file_name_;
};

/// What stands in the block, with a margin.
Eigen::AlignedBox2d extent_of(const BlockProducts& block) {
  Eigen::AlignedBox2d box;
  for (const RowProduct& row : block.rows)
    for (const Eigen::Vector2d& p : row.centreline) box.extend(p);
  for (const PanelProduct& panel : block.panels)
    for (const Eigen::Vector2d& p : panel.outline) box.extend(p);
  if (box.isEmpty()) return box;
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(0.05 * box.diagonal().norm() + 1);
  return {box.min() - margin, box.max() + margin};
}

}  // namespace

Project block_project(const BlockProducts& block, const ColorScale& panel_scale, std::span<const ProjectMap> maps,
                      const std::string& file_name) {
  const BlockLayers layers(block, panel_scale, maps, file_name);
  Project project;
  project.title = block.farm.empty() ? block.block : block.block + ", " + block.farm;
  project.extent = extent_of(block);
  project.relations = {
      {"panel_value_of_panel", "values of the panel on all dates", id("panel"), id("panel_value"), "panel_uid"}};
  Group dates{"Dates, one at a time", {}};
  dates.one_at_a_time = true;
  const std::size_t count = block.scans.size();
  for (std::size_t i = count; i-- > 0;) dates.groups.push_back(layers.date(i, i + 1 == count));
  for (Group group : {layers.all_panels(), layers.all_maps()})
    if (!group.layers.empty()) dates.groups.push_back(std::move(group));
  project.groups = {layers.outlines(), std::move(dates), layers.tables()};
  if (count > 0) {
    project.first_time = layers.day(count - 1);
    project.time = {layers.day(0).begin, project.first_time.end};
  }
  return project;
}

}  // namespace rayfield::formats::qgis
