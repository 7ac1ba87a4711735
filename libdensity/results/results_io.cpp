#include "libdensity/results/results_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "libdensity/results/stored_descriptors.h"
#include "rayfield/tile/whole_number.h"

namespace rayfield::density {
namespace {

using nlohmann::json;

// The columns of a panel's values, in one place for writing and reading.
constexpr std::array<std::pair<const char*, double PanelValue::*>, 11> kPanelColumns{{
    {"plant_area_m2", &PanelValue::plant_area_m2},
    {"leaf_area_m2", &PanelValue::leaf_area_m2},
    {"leaf_area_per_m", &PanelValue::leaf_area_per_m},
    {"lai", &PanelValue::lai},
    {"se_leaf_area_m2", &PanelValue::se_leaf_area_m2},
    {"ci_low_m2", &PanelValue::ci_low_m2},
    {"ci_high_m2", &PanelValue::ci_high_m2},
    {"canopy_height_m", &PanelValue::canopy_height_m},
    {"canopy_width_m", &PanelValue::canopy_width_m},
    {"gap_fraction", &PanelValue::gap_fraction},
    {"observed_fraction", &PanelValue::observed_fraction},
}};

tl::unexpected<Error> damaged(const std::string& what, const std::string& why) {
  return fail(ErrorCode::damaged, "cannot read derived data", what, why, "run `rayfield verify`");
}

json grid_json(const Grid2<float>& grid) {
  return {{"origin", {grid.origin.x(), grid.origin.y()}}, {"cell_m", grid.cell_m}, {"nx", grid.nx}, {"ny", grid.ny}};
}

// A grid from its description, without values; as many as it has cells are taken off `left`.
Result<Grid2<float>> grid_from(const json& description, std::uint64_t& left, const std::string& what) {
  Grid2<float> grid;
  grid.origin = {description.at("origin").at(0).get<double>(), description.at("origin").at(1).get<double>()};
  grid.cell_m = description.at("cell_m").get<double>();
  grid.nx = tile::whole_number<int>(description.at("nx"));
  grid.ny = tile::whole_number<int>(description.at("ny"));
  if (grid.nx < 0 || grid.ny < 0) return damaged(what, "a grid has a negative size");
  if (!grid.origin.allFinite() || !std::isfinite(grid.cell_m) || grid.cell_m <= 0)
    return damaged(what, "a grid has no place or no cells");
  const std::uint64_t count = static_cast<std::uint64_t>(grid.nx) * static_cast<std::uint64_t>(grid.ny);
  if (count > left) return damaged(what, "a grid is cut short");
  left -= count;
  return grid;
}

// What came with canopy descriptors; results of earlier versions have none of it.
void put_canopy(const ScanResults& results, tile::ArraySet& arrays) {
  put_descriptors(kPlantDescriptors, "panel_", results.panel_values, arrays);
  put_descriptors(kLeafDescriptors, "panel_", results.panel_values, arrays);
  put_descriptors(kPlantDescriptors, "metre_", results.row_metres, arrays);
  put_descriptors(kLeafDescriptors, "metre_", results.row_metres, arrays);
  std::vector<double> height, width;
  for (const RowMetreProduct& metre : results.row_metres)
    height.push_back(metre.canopy_height_m), width.push_back(metre.canopy_width_m);
  arrays.columns["metre_canopy_height_m"] = std::move(height);
  arrays.columns["metre_canopy_width_m"] = std::move(width);

  std::map<std::string, std::int32_t> index;  // of a panel among the values
  for (const PanelValue& value : results.panel_values)
    index.emplace(value.panel_uid, static_cast<std::int32_t>(index.size()));
  std::vector<std::int32_t> panel;
  std::vector<double> low, high, plant, leaf;
  for (const PanelProfileBand& band : results.profile) {
    panel.push_back(index.at(band.panel_uid));
    low.push_back(band.height_low_m), high.push_back(band.height_high_m);
    plant.push_back(band.plant_area_m2), leaf.push_back(band.leaf_area_m2);
  }
  arrays.columns["profile_panel"] = std::move(panel);
  arrays.columns["profile_height_low_m"] = std::move(low);
  arrays.columns["profile_height_high_m"] = std::move(high);
  arrays.columns["profile_plant_area_m2"] = std::move(plant);
  arrays.columns["profile_leaf_area_m2"] = std::move(leaf);
}

Result<void> take_profile(const tile::ArraySet& arrays, ScanResults& results) {
  if (!arrays.columns.contains("profile_panel")) return {};
  RAYFIELD_ASSIGN(const auto panel, arrays.column<std::int32_t>("profile_panel"));
  RAYFIELD_ASSIGN(const auto low, arrays.column<double>("profile_height_low_m"));
  RAYFIELD_ASSIGN(const auto high, arrays.column<double>("profile_height_high_m"));
  RAYFIELD_ASSIGN(const auto plant, arrays.column<double>("profile_plant_area_m2"));
  RAYFIELD_ASSIGN(const auto leaf, arrays.column<double>("profile_leaf_area_m2"));
  for (const std::size_t size : {low.size(), high.size(), plant.size(), leaf.size()})
    if (size != panel.size()) return damaged("results", "columns differ in length");
  for (std::size_t i = 0; i < panel.size(); ++i) {
    if (panel[i] < 0 || static_cast<std::size_t>(panel[i]) >= results.panel_values.size())
      return damaged("results", "a band of a profile is of no panel");
    const std::string& uid = results.panel_values[static_cast<std::size_t>(panel[i])].panel_uid;
    results.profile.push_back({uid, results.scan.scan_id, results.scan.scan_date, low[i], high[i], plant[i], leaf[i]});
  }
  return {};
}

Result<void> take_canopy(const tile::ArraySet& arrays, ScanResults& results) {
  const auto panel = [&](std::size_t i) -> PanelValue& { return results.panel_values[i]; };
  const auto metre = [&](std::size_t i) -> RowMetreProduct& { return results.row_metres[i]; };
  RAYFIELD_CHECK(take_descriptors(kPlantDescriptors, "panel_", arrays, results.panel_values.size(), panel));
  RAYFIELD_CHECK(take_descriptors(kLeafDescriptors, "panel_", arrays, results.panel_values.size(), panel));
  RAYFIELD_CHECK(take_descriptors(kPlantDescriptors, "metre_", arrays, results.row_metres.size(), metre));
  RAYFIELD_CHECK(take_descriptors(kLeafDescriptors, "metre_", arrays, results.row_metres.size(), metre));
  if (arrays.columns.contains("metre_canopy_height_m")) {
    RAYFIELD_ASSIGN(const auto height, arrays.column<double>("metre_canopy_height_m"));
    RAYFIELD_ASSIGN(const auto width, arrays.column<double>("metre_canopy_width_m"));
    if (height.size() != results.row_metres.size() || width.size() != results.row_metres.size())
      return damaged("results", "columns differ in length");
    for (std::size_t i = 0; i < height.size(); ++i)
      metre(i).canopy_height_m = height[i], metre(i).canopy_width_m = width[i];
  }
  return take_profile(arrays, results);
}

}  // namespace

tile::StreamedArrays results_to_arrays(const ScanResults& results, const RowLayout& layout,
                                       tile::ColumnSource section_values) {
  tile::ArraySet arrays;
  arrays.kind = "results";
  std::map<std::string, const Panel*> panels;
  for (const Panel& panel : layout.panels) panels[panel.identity.uid] = &panel;

  std::vector<std::int32_t> row, number;
  std::vector<std::int64_t> rays;
  for (const PanelValue& value : results.panel_values) {
    const Panel* panel = panels.at(value.panel_uid);
    row.push_back(panel->row), number.push_back(panel->number), rays.push_back(value.ray_count);
  }
  arrays.columns["panel_row"] = std::move(row);
  arrays.columns["panel_number"] = std::move(number);
  arrays.columns["panel_ray_count"] = std::move(rays);
  for (const auto& [name, member] : kPanelColumns) {
    std::vector<double> column;
    for (const PanelValue& value : results.panel_values) column.push_back(value.*member);
    arrays.columns[std::string("panel_") + name] = std::move(column);
  }

  std::vector<std::int32_t> metre_row;
  std::vector<double> chainage, easting, northing, leaf, plant;
  for (const RowMetreProduct& metre : results.row_metres) {
    metre_row.push_back(metre.row_number), chainage.push_back(metre.chainage_m);
    easting.push_back(metre.position.x()), northing.push_back(metre.position.y());
    leaf.push_back(metre.leaf_area_per_m), plant.push_back(metre.plant_area_per_m);
  }
  arrays.columns["metre_row"] = std::move(metre_row);
  arrays.columns["metre_chainage_m"] = std::move(chainage);
  arrays.columns["metre_easting_m"] = std::move(easting);
  arrays.columns["metre_northing_m"] = std::move(northing);
  arrays.columns["metre_leaf_area_per_m"] = std::move(leaf);
  arrays.columns["metre_plant_area_per_m"] = std::move(plant);

  put_canopy(results, arrays);

  json sections = json::array();
  for (const SectionProduct& section : results.sections)
    sections.push_back({{"name", section.name},
                        {"unit", section.unit},
                        {"row", section.row_number},
                        {"grid", grid_json(section.grid)}});
  arrays.attributes = json{{"sections", sections},
                           {"element_area_m2", results.leaf_size_m2},
                           {"fruit_zone_m", {results.scan.fruit_zone_low_m, results.scan.fruit_zone_high_m}}}
                          .dump();
  return {std::move(arrays), {{kSectionValues, std::move(section_values)}}};
}

Result<ScanResults> results_from_arrays(const tile::ArraySet& arrays, const RowLayout& layout,
                                        const ScanProduct& scan) {
  if (arrays.kind != "results" || arrays.version != 1) return damaged(arrays.kind, "not results of version 1");
  ScanResults results;
  results.scan = scan;
  std::map<std::pair<int, int>, std::string> uids;
  for (const Panel& panel : layout.panels) uids[{panel.row, panel.number}] = panel.identity.uid;

  RAYFIELD_ASSIGN(const auto row, arrays.column<std::int32_t>("panel_row"));
  RAYFIELD_ASSIGN(const auto number, arrays.column<std::int32_t>("panel_number"));
  RAYFIELD_ASSIGN(const auto rays, arrays.column<std::int64_t>("panel_ray_count"));
  if (number.size() != row.size() || rays.size() != row.size()) return damaged("results", "columns differ in length");
  results.panel_values.resize(row.size());
  for (std::size_t i = 0; i < row.size(); ++i) {
    const auto uid = uids.find({row[i], number[i]});
    if (uid == uids.end()) return damaged("results", "a panel is not in the layout");
    PanelValue& value = results.panel_values[i];
    value.panel_uid = uid->second, value.scan_id = scan.scan_id, value.scan_date = scan.scan_date;
    value.ray_count = rays[i];
  }
  for (const auto& [name, member] : kPanelColumns) {
    RAYFIELD_ASSIGN(const auto column, arrays.column<double>(std::string("panel_") + name));
    if (column.size() != row.size()) return damaged("results", "columns differ in length");
    for (std::size_t i = 0; i < row.size(); ++i) results.panel_values[i].*member = column[i];
  }

  // What a scan's own rays say of leaves and plants is as uncertain: posts and trunks are known.
  for (PanelValue& value : results.panel_values) {
    const double known = value.plant_area_m2 - value.leaf_area_m2;
    value.se_plant_area_m2 = value.se_leaf_area_m2;
    value.plant_ci_low_m2 = known + value.ci_low_m2, value.plant_ci_high_m2 = known + value.ci_high_m2;
  }

  RAYFIELD_ASSIGN(const auto metre_row, arrays.column<std::int32_t>("metre_row"));
  RAYFIELD_ASSIGN(const auto chainage, arrays.column<double>("metre_chainage_m"));
  RAYFIELD_ASSIGN(const auto easting, arrays.column<double>("metre_easting_m"));
  RAYFIELD_ASSIGN(const auto northing, arrays.column<double>("metre_northing_m"));
  RAYFIELD_ASSIGN(const auto leaf, arrays.column<double>("metre_leaf_area_per_m"));
  RAYFIELD_ASSIGN(const auto plant, arrays.column<double>("metre_plant_area_per_m"));
  const std::size_t count = metre_row.size();
  for (const std::size_t size : {chainage.size(), easting.size(), northing.size(), leaf.size(), plant.size()})
    if (size != count) return damaged("results", "columns differ in length");
  for (std::size_t i = 0; i < count; ++i)
    results.row_metres.push_back(
        {metre_row[i], chainage[i], {easting[i], northing[i]}, scan.scan_id, scan.scan_date, leaf[i], plant[i]});

  RAYFIELD_CHECK(take_canopy(arrays, results));

  try {
    const json attributes = json::parse(arrays.attributes);
    results.leaf_size_m2 = attributes.at("element_area_m2").get<double>();
    if (attributes.contains("fruit_zone_m") && !attributes.at("fruit_zone_m").at(0).is_null()) {
      results.scan.fruit_zone_low_m = attributes.at("fruit_zone_m").at(0).get<double>();
      results.scan.fruit_zone_high_m = attributes.at("fruit_zone_m").at(1).get<double>();
    }
  } catch (const std::exception& e) {
    return damaged("results", e.what());
  }
  return results;
}

Result<std::vector<SectionProduct>> sections_of(const tile::ArraySet& header, std::uint64_t value_count) {
  if (header.kind != "results" || header.version != 1) return damaged(header.kind, "not results of version 1");
  try {
    std::vector<SectionProduct> sections;
    const json attributes = json::parse(header.attributes);
    for (const json& section : attributes.at("sections")) {
      SectionProduct product{section.at("name").get<std::string>(),
                             section.at("unit").get<std::string>(),
                             tile::whole_number<int>(section.at("row")),
                             {}};
      RAYFIELD_ASSIGN(product.grid, grid_from(section.at("grid"), value_count, "results"));
      sections.push_back(std::move(product));
    }
    return sections;
  } catch (const std::exception& e) {
    return damaged("results", e.what());
  }
}

tile::StreamedArrays raster_to_arrays(const RasterProduct& raster, tile::ColumnSource values) {
  tile::ArraySet arrays;
  arrays.kind = "raster";
  arrays.attributes = json{{"name", raster.name},
                           {"unit", raster.unit},
                           {"description", raster.description},
                           {"grid", grid_json(raster.grid)}}
                          .dump();
  return {std::move(arrays), {{kRasterValues, std::move(values)}}};
}

Result<RasterProduct> raster_of(const tile::ArraySet& header, std::uint64_t value_count) {
  if (header.kind != "raster" || header.version != 1) return damaged(header.kind, "not a raster of version 1");
  try {
    const json attributes = json::parse(header.attributes);
    RasterProduct raster{attributes.at("name").get<std::string>(),
                         attributes.at("unit").get<std::string>(),
                         attributes.at("description").get<std::string>(),
                         {}};
    RAYFIELD_ASSIGN(raster.grid, grid_from(attributes.at("grid"), value_count, "raster"));
    return raster;
  } catch (const std::exception& e) {
    return damaged("raster", e.what());
  }
}

Result<void> check_map_values(std::span<const float> values, const std::string& name) {
  if (std::any_of(values.begin(), values.end(), [](float value) { return std::isinf(value); }))
    return damaged(name, "a value is infinite");
  return {};
}

}  // namespace rayfield::density
