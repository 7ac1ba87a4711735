#include "libdensity/leaf/leaf_products.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "libdensity/estimate/leaf_area.h"
#include "libdensity/estimate/plan_raster.h"
#include "libdensity/estimate/raster_frame.h"
#include "libdensity/layout/polyline.h"
#include "libdensity/leaf/leaf_pairs.h"
#include "libdensity/leaf/slab_shadow.h"
#include "libdensity/results/leaf_values.h"
#include "libdensity/results/results_io.h"
#include "libdensity/scan/row_voxels.h"
#include "libdensity/scan/scan_echoes.h"
#include "libdensity/scan/scan_stages.h"
#include "libdensity/scan/scan_voxels.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/accumulate.h"
#include "libdensity/voxels/voxel_arrays.h"
#include "rayfield/density/load.h"

namespace rayfield::density {
namespace {

constexpr const char* kWoodPrefix = "wood_";

struct LeafMaps {
  LeafValues values;
  RasterProduct raster;
};

// The dormant scan's counters on this scan's voxels.
struct CountedWood {
  std::string prefix;  // of their names
  std::vector<tile::TileIndex> tiles;
  std::optional<EchoModel> echoes;
};

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

// Voxels were fitted to what the leafy scan shows, wood with it, and are never smaller or larger than the options say.
// What densities are multiplied by for them to be those of voxels that fit the leaves (docs/density.md, "Leaf area").
double scale_to_fitted_voxels(double leaf_size_m2, double voxel_m, const VoxelFitOptions& fit) {
  if (!fit.enabled) return 1;
  const double fitted_m = fit.leaf_sides * std::sqrt(leaf_size_m2);
  return 1 / (1 + slab_shadow(leaf_size_m2, voxel_m) - slab_shadow(leaf_size_m2, fitted_m));
}

void scale_density(RowDensity& row, double scale) {
  for (float& density : row.density) density = static_cast<float>(scale * static_cast<double>(density));
  for (float& variance : row.variance) variance = static_cast<float>(scale * scale * static_cast<double>(variance));
}

// The leaves of one row; appends to the maps. `panel`: the next of the results' panels.
void integrate_row(const ScanWork& work, const Row& row, std::span<const Panel> panels, double spacing_m,
                   const IntegrationOptions& integration, const RowDensity& leaf, const RowDensity& wood,
                   std::size_t& panel, LeafMaps& maps, PlanRaster& raster) {
  const std::vector<LeafSum> sums = leaf_of_panels(leaf, wood, panels);
  for (std::size_t i = 0; i < sums.size(); ++i)
    set_leaf_area(maps.values.panels[panel++], sums[i], panels[i].end_m - panels[i].start_m, spacing_m, integration,
                  work.options.leaf);
  for (const double area : leaf_of_metres(leaf, row.length_m(), integration.metre_step_m))
    maps.values.metres.push_back(area);
  raster.add(leaf);
}

// Rows in the order in which the results were made of them.
Result<LeafMaps> subtract_rows(ScanWork& work, const RowLayout& layout, const ScanVoxels& voxels,
                               const CountedWood& counted, ScanResults results, const RasterProduct& plan) {
  LeafMaps maps;
  maps.values.panels = std::move(results.panel_values);
  const std::size_t bytes = work.options.memory_bytes / 16;
  RAYFIELD_ASSIGN(RowVoxels plant, RowVoxels::open(work, "", voxels.tiles, bytes));
  RAYFIELD_ASSIGN(RowVoxels wood, RowVoxels::open(work, counted.prefix, counted.tiles, bytes));
  RAYFIELD_ASSIGN(const RasterFrame frame, plan_frame(layout, work.options.plan.cell_m));
  RAYFIELD_ASSIGN(PlanRaster raster, PlanRaster::create(frame, voxels.row_segments.row_segments, work.options.plan));
  work.progress.stage(fmt::format("{}: leaves", work.scan.scan_id), layout.rows.size(), "rows");
  const IntegrationOptions integration = integration_with_beam(work.options.integration, work.scan, voxels.echoes);
  RAYFIELD_ASSIGN(const std::optional<double> leaf_size_m2, leaf_size_of(work, voxels, counted));
  double scale = 1;
  if (leaf_size_m2 && !voxels.row_segments.row_segments.empty())
    scale =
        scale_to_fitted_voxels(*leaf_size_m2, voxels.row_segments.row_segments.front().voxel_m, work.options.voxel_fit);
  std::size_t panel = 0;
  for (const Row& row : layout.rows) {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    if (!plant.has_row(row.number)) continue;
    EstimatorOptions options = work.options.estimator;
    if (leaf_size_m2) options.leaf_size_m2 = *leaf_size_m2;
    RAYFIELD_ASSIGN(RowDensity of_plant,
                    plant.density(row.number, voxels.row_segments, voxels.wood, options, voxels.echoes));
    options.leaf_size_m2 = of_plant.leaf_size_m2;
    RAYFIELD_ASSIGN(RowDensity of_wood,
                    wood.density(row.number, voxels.row_segments, voxels.wood, options, counted.echoes));
    // The published method knows nothing of how leaves are turned.
    if (options.estimator == Estimator::paper) of_plant.leaf_size_m2 = of_wood.leaf_size_m2 = 0;
    RAYFIELD_ASSIGN(RowDensity leaf, subtract_wood(std::move(of_plant), of_wood));
    scale_density(leaf, scale);
    integrate_row(work, row, panels_of(layout, row.number), layout.spacing_m, integration, leaf, of_wood, panel, maps,
                  raster);
    work.progress.advance(1);
  }
  maps.raster = raster.finish().front();
  maps.raster.name = kLeafRasterName;
  maps.raster.description = "One-sided leaf area above a square metre of ground; noise falls below 0, too";
  // Lanes have no voxels; where there are no plants there are no leaves.
  for (std::size_t i = 0; i < maps.raster.grid.values.size() && i < plan.grid.values.size(); ++i)
    if (std::isnan(maps.raster.grid.values[i]) && plan.grid.values[i] == 0) maps.raster.grid.values[i] = 0;
  return maps;
}

std::string leaf_key(const ScanWork& work, const ScanVoxels& voxels, const WoodScan& wood, const CountedWood& counted) {
  KeyBuilder key("leaf", kLeafVersion);
  key.add(wood.scan.scan_id).add(content_of(wood.scan)).add(work.layout_key);
  key.add(work.files.sha256("results", "block"));
  key.add(option_numbers(work.options.leaf)).add(option_numbers(work.options.estimator));
  key.add(option_numbers(work.options.voxel_fit));
  key.add(option_numbers(integration_with_beam(work.options.integration, work.scan, voxels.echoes)))
      .add(option_numbers(work.options.plan));
  if (voxels.echoes) key.add(model_numbers(voxels.echoes)).add(model_numbers(counted.echoes));
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
  ScanWork of_wood{work.store, wood.scan, work.options, files, work.progress, work.threads};
  RAYFIELD_ASSIGN(const std::vector<TileSurvey> surveys, survey_tiles(of_wood));
  tile::ScanEntry alike = wood.scan;
  alike.beam = work.scan.beam;
  return view_of(alike, surveys, work.options.beam);
}

LeafReport report_of(const ScanResults& results) {
  LeafReport report;
  report.panels = results.panel_values.size();
  for (const PanelValue& value : results.panel_values) {
    if (std::isfinite(value.leaf_area_m2)) report.leaf_area_m2 += value.leaf_area_m2;
    if (std::isfinite(value.plant_area_m2) && !std::isfinite(value.leaf_area_m2)) ++report.without_wood;
  }
  return report;
}

}  // namespace

std::string content_of(const tile::ScanEntry& scan) {
  KeyBuilder content("rays", 1);
  for (const tile::TileEntry& entry : scan.tiles) content.add(entry.content_sha256());
  return content.hex();
}

Result<LeafReport> read_leaves(ScanWork& work, const RowLayout& layout) {
  RAYFIELD_ASSIGN(const tile::ArraySet result_arrays, work.files.read("results", "block"));
  RAYFIELD_ASSIGN(ScanResults results, results_from_arrays(result_arrays, layout, {}));
  RAYFIELD_ASSIGN(const tile::ArraySet leaf_arrays, work.files.read("leaf", "block"));
  RAYFIELD_CHECK(put_leaf_values(leaf_arrays, layout, results));
  return report_of(results);
}

Result<LeafReport> separate_leaves(ScanWork& work, const RowLayout& layout, const ScanVoxels& voxels,
                                   const WoodScan& wood) {
  CountedWood counted{"", voxels.tiles, voxels.echoes};  // of the scan itself: leaf areas are exactly 0
  if (wood.scan.scan_id != work.scan.scan_id) {
    counted.prefix = kWoodPrefix;
    RAYFIELD_ASSIGN(const auto view, view_of_wood(work, voxels, wood));
    if (!view) counted.echoes.reset();
    RAYFIELD_ASSIGN(counted.tiles, count_voxels(work, {wood.scan, wood.voxels, counted.prefix, view},
                                                voxels.row_segments, voxels.wood));
  }
  const std::string key = leaf_key(work, voxels, wood, counted);
  RAYFIELD_ASSIGN(const tile::ArraySet result_arrays, work.files.read("results", "block"));
  RAYFIELD_ASSIGN(ScanResults results, results_from_arrays(result_arrays, layout, {}));

  std::optional<LeafMaps> maps;
  const auto made = [&]() -> Result<void> {
    if (maps) return {};
    RAYFIELD_ASSIGN(const tile::ArraySet plan_arrays, work.files.read("raster", "plan_density"));
    RAYFIELD_ASSIGN(const RasterProduct plan, raster_from_arrays(plan_arrays));
    RAYFIELD_ASSIGN(maps, subtract_rows(work, layout, voxels, counted, results, plan));
    maps->values.wood_scan_id = wood.scan.scan_id, maps->values.wood_content = content_of(wood.scan);
    return {};
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get("leaf", "block", key, [&]() -> Result<tile::ArraySet> {
    RAYFIELD_CHECK(made());
    return leaf_to_arrays(maps->values, layout);
  }));
  RAYFIELD_CHECK(work.files.get("raster", kLeafRasterName, key, [&]() -> Result<tile::ArraySet> {
    RAYFIELD_CHECK(made());
    return raster_to_arrays(maps->raster);
  }));
  RAYFIELD_CHECK(put_leaf_values(arrays, layout, results));
  return report_of(results);
}

}  // namespace rayfield::density
