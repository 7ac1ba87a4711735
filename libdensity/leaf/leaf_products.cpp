#include "libdensity/leaf/leaf_products.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "libdensity/echoes/echo_model_arrays.h"
#include "libdensity/integration/leaf_area.h"
#include "libdensity/leaf/leaf_maps.h"
#include "libdensity/leaf/leaf_pairs.h"
#include "libdensity/leaf/wood_estimate.h"
#include "libdensity/results/leaf_values.h"
#include "libdensity/results/results_io.h"
#include "libdensity/scan/row_voxels.h"
#include "libdensity/scan/scan_echoes.h"
#include "libdensity/scan/scan_sides.h"
#include "libdensity/scan/scan_stages.h"
#include "libdensity/scan/scan_voxels.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/voxels/voxel_arrays.h"
#include "rayfield/density/load.h"

namespace rayfield::density {
namespace {

constexpr const char* kWoodPrefix = "wood_";

// The dormant scan's counters on this scan's voxels.
struct CountedWood {
  std::string prefix;  // of their names
  std::vector<tile::TileIndex> tiles;
  bool weighed = false;  // by this scan's full echo
};

// The wood is seen in both scans, so that it cancels.
std::optional<EchoModel> subtractable(const std::optional<EchoModel>& model) {
  return model ? std::optional(with_wood_as_leaves(*model)) : std::nullopt;
}

// The size of the leaves alone: as given, or where both scans together tell it. Of beams that are not thin the model
// knows it, for wood and leaves together.
Result<std::optional<double>> leaf_size_of(ScanWork& work, const ScanVoxels& voxels, const CountedWood& counted) {
  const EstimatorOptions& options = work.options.estimator;
  if (options.estimator == Estimator::paper || counted.prefix.empty() || voxels.echoes) return std::optional<double>();
  if (options.leaf_size_m2 >= 0) return std::optional(options.leaf_size_m2);
  LeafPairs pairs;
  for (const tile::TileIndex index : counted.tiles) {
    if (std::find(voxels.tiles.begin(), voxels.tiles.end(), index) == voxels.tiles.end()) continue;
    RAYFIELD_ASSIGN(const tile::ArraySet plant_arrays, work.files.read("voxels", tile_name(index)));
    RAYFIELD_ASSIGN(const tile::ArraySet wood_arrays, work.files.read("voxels", counted.prefix + tile_name(index)));
    RAYFIELD_ASSIGN(const TileVoxels plant, voxels_from_arrays(plant_arrays));
    RAYFIELD_ASSIGN(const TileVoxels wood, voxels_from_arrays(wood_arrays));
    pairs.add(plant, wood);
  }
  return pairs.leaf_size_m2();
}

// How the densities of rows are estimated: as of leaves alone.
Result<EstimatorOptions> estimator_of(ScanWork& work, const ScanVoxels& voxels, const CountedWood& counted) {
  EstimatorOptions estimator = work.options.estimator;
  RAYFIELD_ASSIGN(const std::optional<double> leaf_size_m2, leaf_size_of(work, voxels, counted));
  if (leaf_size_m2) estimator.leaf_size_m2 = *leaf_size_m2;
  return estimator;
}

// The rows of the results, in the order in which those were made of them.
std::vector<const Row*> rows_of(const RowLayout& layout, const RowVoxels& plant) {
  std::vector<const Row*> rows;
  for (const Row& row : layout.rows)
    if (plant.has_row(row.number)) rows.push_back(&row);
  return rows;
}

Result<LeafMaps> subtract_rows(ScanWork& work, const RowLayout& layout, const ScanVoxels& voxels,
                               const CountedWood& counted, const ScanResults& results) {
  const std::size_t bytes = work.memory.tiles_bytes / 2;
  RAYFIELD_ASSIGN(RowVoxels plant, RowVoxels::open(work, "", voxels.tiles, bytes));
  RAYFIELD_ASSIGN(RowVoxels wood, RowVoxels::open(work, counted.prefix, counted.tiles, bytes));
  const IntegrationOptions integration = integration_of_scan(work, voxels);
  RAYFIELD_ASSIGN(const EstimatorOptions estimator, estimator_of(work, voxels, counted));
  const std::optional<EchoModel> of_leaves = subtractable(voxels.echoes);
  const auto of_counted = counted.weighed ? of_leaves : std::nullopt;
  const auto leaves_of = [&](const Row& row, std::span<const Panel> panels,
                             std::span<PanelValue> values) -> Result<RowDensity> {
    EstimatorOptions options = estimator;
    RAYFIELD_ASSIGN(RowDensity of_plant,
                    plant.density(row.number, voxels.row_segments, voxels.wood, options, of_leaves));
    options.leaf_size_m2 = of_plant.leaf_size_m2;
    RAYFIELD_ASSIGN(RowDensity of_wood,
                    wood.density(row.number, voxels.row_segments, voxels.wood, options, of_counted));
    // The published method knows nothing of how leaves are turned.
    if (options.estimator == Estimator::paper) of_plant.leaf_size_m2 = of_wood.leaf_size_m2 = 0;
    RAYFIELD_ASSIGN(RowDensity leaf, subtract_wood(std::move(of_plant), of_wood));
    const std::vector<LeafSum> sums = leaf_of_panels(leaf, of_wood, panels);
    for (std::size_t k = 0; k < panels.size(); ++k)
      set_leaf_area(values[k], sums[k], panels[k].end_m - panels[k].start_m, layout.spacing_m,
                    integration_of_row(integration, work.scan, row.number, voxels.rows_from_one_side),
                    work.options.leaf);
    return leaf;
  };
  return make_leaf_maps(work, rows_of(layout, plant), layout, voxels, results, leaves_of);
}

Result<LeafMaps> take_out_of_rows(ScanWork& work, const RowLayout& layout, const ScanVoxels& voxels,
                                  const PanelPlants& barest, const ScanResults& results) {
  RAYFIELD_ASSIGN(RowVoxels plant, RowVoxels::open(work, "", voxels.tiles, work.memory.tiles_bytes));
  const auto leaves_of = [&](const Row& row, std::span<const Panel> panels,
                             std::span<PanelValue> values) -> Result<RowDensity> {
    RAYFIELD_ASSIGN(RowDensity of_plant,
                    plant.density(row.number, voxels.row_segments, voxels.wood, work.options.estimator, voxels.echoes));
    return take_out_wood(std::move(of_plant), panels, barest, work.options.wood, values);
  };
  return make_leaf_maps(work, rows_of(layout, plant), layout, voxels, results, leaves_of);
}

// What leaf areas depend on beside the wood.
void add_plants(const ScanWork& work, const ScanVoxels& voxels, KeyBuilder& key) {
  key.add(work.layout_key).add(work.files.sha256("results", "block"));
  key.add(option_numbers(work.options.descriptors)).add(option_numbers(work.voxels.leaf_angles));
  key.add(option_numbers(work.options.estimator)).add(option_numbers(work.options.plan));
  key.add(option_numbers(integration_of_scan(work, voxels)));
  if (voxels.echoes) key.add(model_numbers(voxels.echoes));
  for (const tile::TileIndex index : voxels.tiles) key.add(work.files.sha256("voxels", tile_name(index)));
}

std::string leaf_key(const ScanWork& work, const ScanVoxels& voxels, const WoodScan& wood, const CountedWood& counted) {
  KeyBuilder key("leaf", kLeafVersion);
  key.add(wood.scan.scan_id).add(content_of(wood.scan)).add(work.layout_key);
  key.add(work.files.sha256("results", "block"));
  key.add(option_numbers(work.options.descriptors)).add(option_numbers(work.voxels.leaf_angles));
  key.add(option_numbers(work.options.leaf)).add(option_numbers(work.options.estimator));
  key.add(option_numbers(work.options.voxel_fit));
  key.add(option_numbers(integration_of_scan(work, voxels))).add(option_numbers(work.options.plan));
  if (voxels.echoes) key.add(model_numbers(voxels.echoes)).add(static_cast<std::int64_t>(counted.weighed));
  key.add(std::vector<double>(voxels.rows_from_one_side.begin(), voxels.rows_from_one_side.end()));
  for (const tile::TileIndex index : voxels.tiles) key.add(work.files.sha256("voxels", tile_name(index)));
  for (const tile::TileIndex index : counted.tiles)
    key.add(work.files.sha256("voxels", counted.prefix + tile_name(index)));
  return key.hex();
}

// How the dormant scan's beams look at the voxels, where they are like this scan's. What was measured of them is taken
// from this scan, so that what is wrong about it is alike in both.
Result<std::shared_ptr<const BeamView>> view_of_wood(ScanWork& work, const ScanVoxels& voxels, const WoodScan& wood) {
  if (!voxels.echoes || !wood.scan.beam || !wood.scan.beam->same_disc(voxels.echoes->beam)) return nullptr;
  Derivation files = work.files.for_scan(wood.scan.scan_id);
  ScanWork of_wood{work.store, wood.scan, work.options, files, work.progress};
  RAYFIELD_ASSIGN(const ScanSurvey survey, survey_tiles(of_wood));
  tile::ScanEntry alike = wood.scan;
  alike.beam = work.scan.beam;
  alike.beam->range_resolution_m = voxels.echoes->range_resolution_m;
  return view_of(alike, survey, work.options.beam);
}

LeafReport report_of(const ScanResults& results) {
  LeafReport report;
  report.panels = results.panel_values.size();
  for (const PanelValue& value : results.panel_values) {
    if (std::isfinite(value.leaf_area_m2)) {
      report.leaf_area_m2 += value.leaf_area_m2;
      report.low_m2 += value.ci_low_m2, report.high_m2 += value.ci_high_m2;
    }
    if (std::isfinite(value.plant_area_m2) && !std::isfinite(value.leaf_area_m2)) ++report.without_wood;
  }
  return report;
}

// Takes leaf areas and their map from the scan's files, or makes them and keeps them there.
Result<LeafReport> keep_leaves(ScanWork& work, const RowLayout& layout, const std::string& key,
                               const std::function<Result<LeafMaps>()>& make) {
  std::optional<LeafMaps> maps;
  const auto made = [&]() -> Result<void> {
    if (maps) return {};
    RAYFIELD_ASSIGN(maps, make());
    return {};
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get("leaf", "block", key, [&]() -> Result<tile::ArraySet> {
    RAYFIELD_CHECK(made());
    return leaf_to_arrays(maps->values, layout);
  }));
  RAYFIELD_CHECK(work.files.ensure("raster", kLeafRasterName, key, [&]() -> Result<tile::StreamedArrays> {
    RAYFIELD_CHECK(made());
    return leaf_map_to_arrays(work, *maps);
  }));
  RAYFIELD_ASSIGN(ScanResults results, read_results(work, layout));
  RAYFIELD_CHECK(put_leaf_values(arrays, layout, results));
  return report_of(results);
}

}  // namespace

IntegrationOptions integration_of_scan(const ScanWork& work, const ScanVoxels& voxels) {
  IntegrationOptions options = integration_with_beam(work.options.integration, work.scan, voxels.echoes);
  options.shared_error = std::min(1.0, std::hypot(options.shared_error, voxels.leaf_angles.area_error()));
  return options;
}

std::string content_of(const tile::ScanEntry& scan) {
  KeyBuilder content("rays", 1);
  for (const tile::TileEntry& entry : scan.tiles) content.add(entry.content_sha256());
  return content.hex();
}

Result<ScanResults> read_results(const ScanWork& work, const RowLayout& layout) {
  RAYFIELD_ASSIGN(const tile::ArrayReader stored, work.files.open("results", "block"));
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, stored.read_without({kSectionValues}));
  return results_from_arrays(arrays, layout, {});
}

Result<LeafReport> read_leaves(ScanWork& work, const RowLayout& layout) {
  RAYFIELD_ASSIGN(ScanResults results, read_results(work, layout));
  RAYFIELD_ASSIGN(const tile::ArraySet leaf_arrays, work.files.read("leaf", "block"));
  RAYFIELD_CHECK(put_leaf_values(leaf_arrays, layout, results));
  return report_of(results);
}

Result<LeafReport> separate_leaves(ScanWork& work, const RowLayout& layout, const ScanVoxels& voxels,
                                   const WoodScan& wood) {
  CountedWood counted{"", voxels.tiles, voxels.echoes.has_value()};  // of the scan itself: leaf areas are exactly 0
  if (wood.scan.scan_id != work.scan.scan_id) {
    counted.prefix = kWoodPrefix;
    RAYFIELD_ASSIGN(const auto view, view_of_wood(work, voxels, wood));
    counted.weighed = view != nullptr;
    RAYFIELD_ASSIGN(counted.tiles, count_voxels(work, {wood.scan, wood.voxels, counted.prefix, view, /*pairs=*/false},
                                                voxels.row_segments, voxels.wood));
  }
  RAYFIELD_ASSIGN(const ScanResults results, read_results(work, layout));
  return keep_leaves(work, layout, leaf_key(work, voxels, wood, counted), [&]() -> Result<LeafMaps> {
    RAYFIELD_ASSIGN(LeafMaps maps, subtract_rows(work, layout, voxels, counted, results));
    maps.values.wood_scan_id = wood.scan.scan_id, maps.values.wood_content = content_of(wood.scan);
    return maps;
  });
}

std::string estimate_content(const std::optional<BarestScan>& barest) {
  if (!barest) return kWoodByEstimate;
  KeyBuilder key("barest scan", 1);
  for (const auto& [uid, seen] : barest->plants) key.add(uid).add(std::vector<double>{seen.area_m2, seen.high_m2});
  return std::string(kWoodByEstimate) + ", at most " + barest->scan_id + " " + key.hex();
}

Result<LeafReport> separate_leaves_by_estimate(ScanWork& work, const RowLayout& layout, const ScanVoxels& voxels,
                                               const std::optional<BarestScan>& barest) {
  const std::string content = estimate_content(barest);
  KeyBuilder key("leaf by estimate", kLeafByEstimateVersion);
  key.add(option_numbers(work.options.wood)).add(content);
  add_plants(work, voxels, key);
  RAYFIELD_ASSIGN(const ScanResults results, read_results(work, layout));
  return keep_leaves(work, layout, key.hex(), [&]() -> Result<LeafMaps> {
    RAYFIELD_ASSIGN(LeafMaps maps,
                    take_out_of_rows(work, layout, voxels, barest ? barest->plants : PanelPlants(), results));
    maps.values.wood_content = content;
    return maps;
  });
}

}  // namespace rayfield::density
