#include "libdensity/leaf/leaf_products.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "libdensity/estimate/descriptors.h"
#include "libdensity/estimate/leaf_area.h"
#include "libdensity/estimate/plan_raster.h"
#include "libdensity/estimate/raster_frame.h"
#include "libdensity/layout/polyline.h"
#include "libdensity/leaf/leaf_pairs.h"
#include "libdensity/leaf/slab_shadow.h"
#include "libdensity/results/leaf_values.h"
#include "libdensity/results/results_io.h"
#include "libdensity/results/stored_descriptors.h"
#include "libdensity/scan/row_voxels.h"
#include "libdensity/scan/scan_echoes.h"
#include "libdensity/scan/scan_stages.h"
#include "libdensity/scan/scan_voxels.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/accumulate.h"
#include "libdensity/voxels/voxel_arrays.h"
#include "rayfield/core/parallel.h"
#include "rayfield/density/load.h"

namespace rayfield::density {
namespace {

constexpr const char* kWoodPrefix = "wood_";

struct LeafMaps {
  LeafValues values;
  PlanRaster plan;
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

// One row of both scans.
struct RowLeaves {
  std::optional<RowDensity> leaf;
  std::vector<LeafSum> panels;
  std::vector<PanelValue> described;  // of the results, with the descriptors of leaves
  std::vector<RowMetreProduct> metres;
  std::vector<double> profile;  // band by band, panel by panel
};

// What lines meet of leaves alone, inside the outline of leaves and wood.
void describe_leaves(const RowDensity& leaf, std::span<const Panel> panels, double length_m,
                     std::span<const StretchOutline> outline, const DescriptorSettings& settings, RowLeaves& out) {
  const RowLines lines(leaf, length_m, outline, settings);
  lines.describe_panels(panels, out.described);
  lines.describe_metres(out.metres);
  for (const auto& bands : vertical_profiles(leaf, panels, settings.options.profile_band_m))
    for (const BandAreas& band : bands) out.profile.push_back(band.canopy_area_m2);
}

// Where both scans together saw too little, nothing is said of leaves.
void forget_leaves(CanopyDescriptors& descriptors) {
  for (const auto& [name, member] : kLeafDescriptors) descriptors.*member = CanopyDescriptors::kUndefined;
}

// How the densities of rows are estimated, and what follows from the leaves' size.
struct LeafEstimate {
  EstimatorOptions options;
  double scale = 1;
};

Result<LeafEstimate> estimate_of(ScanWork& work, const ScanVoxels& voxels, const CountedWood& counted) {
  LeafEstimate estimate{work.options.estimator};
  RAYFIELD_ASSIGN(const std::optional<double> leaf_size_m2, leaf_size_of(work, voxels, counted));
  if (!leaf_size_m2) return estimate;
  estimate.options.leaf_size_m2 = *leaf_size_m2;
  const std::vector<RowSegment>& row_segments = voxels.row_segments.row_segments;
  if (!row_segments.empty())
    estimate.scale = scale_to_fitted_voxels(*leaf_size_m2, row_segments.front().voxel_m, work.options.voxel_fit);
  return estimate;
}

Result<RowDensity> leaves_of_row(int row, const ScanVoxels& voxels, const CountedWood& counted, RowVoxels& plant,
                                 RowVoxels& wood, const LeafEstimate& estimate, RowLeaves& out) {
  EstimatorOptions options = estimate.options;
  RAYFIELD_ASSIGN(RowDensity of_plant, plant.density(row, voxels.row_segments, voxels.wood, options, voxels.echoes));
  options.leaf_size_m2 = of_plant.leaf_size_m2;
  RAYFIELD_ASSIGN(RowDensity of_wood, wood.density(row, voxels.row_segments, voxels.wood, options, counted.echoes));
  // The published method knows nothing of how leaves are turned.
  if (options.estimator == Estimator::paper) of_plant.leaf_size_m2 = of_wood.leaf_size_m2 = 0;
  RAYFIELD_ASSIGN(out.leaf, subtract_wood(std::move(of_plant), of_wood));
  scale_density(*out.leaf, estimate.scale);
  return of_wood;
}

tl::unexpected<Error> not_of_this_layout(int row) {
  return fail(ErrorCode::damaged, "cannot use stored results", fmt::format("row {}", row),
              "they are of other panels or half metres", "run `rayfield verify`");
}

// The values of these panels of a row, in their order. Errors: damaged.
Result<std::vector<PanelValue>> values_of(std::span<const PanelValue> values, std::span<const Panel> panels, int row) {
  std::vector<PanelValue> out;
  for (const Panel& panel : panels) {
    const auto found = std::find_if(values.begin(), values.end(), [&panel](const PanelValue& value) {
      return value.panel_uid == panel.identity.uid;
    });
    if (found == values.end()) return not_of_this_layout(row);
    out.push_back(*found);
  }
  return out;
}

// Rows in the order in which the results were made of them.
Result<LeafMaps> subtract_rows(ScanWork& work, const RowLayout& layout, const ScanVoxels& voxels,
                               const CountedWood& counted, const ScanResults& results) {
  const std::size_t bytes = work.memory.tiles_bytes / 2;
  RAYFIELD_ASSIGN(RowVoxels plant, RowVoxels::open(work, "", voxels.tiles, bytes));
  RAYFIELD_ASSIGN(RowVoxels wood, RowVoxels::open(work, counted.prefix, counted.tiles, bytes));
  RAYFIELD_ASSIGN(const RasterFrame frame, plan_frame(layout, work.options.plan.cell_m));
  RAYFIELD_ASSIGN(PlanRaster plan, PlanRaster::create(frame, voxels.row_segments.row_segments, work.options.plan,
                                                      work.memory.maps_bytes, work.files.scratch_folder()));
  LeafMaps maps{{}, std::move(plan)};
  maps.values.panels = results.panel_values;
  work.progress.stage(fmt::format("{}: leaves", work.scan.scan_id), layout.rows.size(), "rows");
  const IntegrationOptions integration = integration_with_beam(work.options.integration, work.scan, voxels.echoes);
  RAYFIELD_ASSIGN(const LeafEstimate estimate, estimate_of(work, voxels, counted));
  RAYFIELD_ASSIGN(const int workers, rows_in_hand(work, voxels.row_segments, voxels.echoes.has_value()));
  std::vector<const Row*> rows;
  for (const Row& row : layout.rows)
    if (plant.has_row(row.number)) rows.push_back(&row);
  const DescriptorSettings settings = descriptor_settings(work.options);
  std::vector<RowLeaves> done(rows.size());
  const auto subtract = [&](std::size_t i, int) -> Result<void> {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    RAYFIELD_ASSIGN(const RowDensity of_wood,
                    leaves_of_row(rows[i]->number, voxels, counted, plant, wood, estimate, done[i]));
    const std::vector<Panel> panels = panels_of(layout, rows[i]->number);
    done[i].panels = leaf_of_panels(*done[i].leaf, of_wood, panels);
    RAYFIELD_ASSIGN(done[i].described, values_of(results.panel_values, panels, rows[i]->number));
    for (const RowMetreProduct& metre : results.row_metres)
      if (metre.row_number == rows[i]->number) done[i].metres.push_back(metre);
    const double length_m = rows[i]->length_m();
    const std::vector<StretchOutline> outline = outline_of(results.row_metres, rows[i]->number);
    const std::vector<double> areas = leaf_of_metres(*done[i].leaf, length_m, integration.metre_step_m);
    if (areas.size() != done[i].metres.size()) return not_of_this_layout(rows[i]->number);
    describe_leaves(*done[i].leaf, panels, length_m, outline, settings, done[i]);
    for (std::size_t k = 0; k < areas.size(); ++k) {
      done[i].metres[k].leaf_area_per_m = areas[k];
      if (std::isnan(areas[k])) forget_leaves(done[i].metres[k].descriptors);
    }
    return {};
  };
  std::size_t panel = 0;  // the next of the results' panels
  const auto take = [&](std::size_t i) -> Result<void> {
    RowLeaves row = std::exchange(done[i], {});
    const std::vector<Panel> panels = panels_of(layout, rows[i]->number);
    const std::size_t bands = panels.empty() ? 0 : row.profile.size() / panels.size();
    for (std::size_t k = 0; k < row.panels.size(); ++k) {
      PanelValue& value = maps.values.panels[panel++];
      value.descriptors = row.described[k].descriptors;
      set_leaf_area(value, row.panels[k], panels[k].end_m - panels[k].start_m, layout.spacing_m, integration,
                    work.options.leaf);
      if (std::isfinite(value.leaf_area_m2)) continue;
      forget_leaves(value.descriptors);
      const auto profile = std::span(row.profile).subspan(k * bands, bands);
      std::fill(profile.begin(), profile.end(), CanopyDescriptors::kUndefined);
    }
    maps.values.metres.insert(maps.values.metres.end(), row.metres.begin(), row.metres.end());
    maps.values.profile.insert(maps.values.profile.end(), row.profile.begin(), row.profile.end());
    RAYFIELD_CHECK(maps.plan.add(*row.leaf));
    work.progress.advance(1);
    return {};
  };
  RAYFIELD_CHECK(parallel_ordered(rows.size(), workers, static_cast<std::size_t>(workers), subtract, take));
  return maps;
}

// The map of leaves as it is stored. Lanes have no voxels; where there are no plants there are no leaves.
Result<tile::StreamedArrays> map_to_arrays(ScanWork& work, LeafMaps& maps) {
  RasterProduct raster = maps.plan.maps().front();
  raster.name = kLeafRasterName;
  raster.description = "One-sided leaf area above a square metre of ground; noise falls below 0, too";
  RAYFIELD_ASSIGN(const tile::ArrayReader plants, work.files.open("raster", "plan_density"));
  RAYFIELD_ASSIGN(const std::uint64_t plant_count, plants.count(kRasterValues));
  const auto read = [&maps, plants, plant_count](std::uint64_t first, std::span<float> values) -> Result<void> {
    RAYFIELD_CHECK(maps.plan.read(0, first, values));
    if (first >= plant_count) return {};
    std::vector<float> plant(std::min<std::uint64_t>(values.size(), plant_count - first));
    RAYFIELD_CHECK(plants.read(kRasterValues, first, plant));
    for (std::size_t i = 0; i < plant.size(); ++i)
      if (std::isnan(values[i]) && plant[i] == 0) values[i] = 0;
    return {};
  };
  const std::uint64_t count = static_cast<std::uint64_t>(raster.grid.nx) * static_cast<std::uint64_t>(raster.grid.ny);
  return raster_to_arrays(raster, {count, read});
}

std::string leaf_key(const ScanWork& work, const ScanVoxels& voxels, const WoodScan& wood, const CountedWood& counted) {
  KeyBuilder key("leaf", kLeafVersion);
  key.add(wood.scan.scan_id).add(content_of(wood.scan)).add(work.layout_key);
  key.add(work.files.sha256("results", "block"));
  key.add(option_numbers(work.options.descriptors)).add(option_numbers(work.options.voxels.leaf_angles));
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
  ScanWork of_wood{work.store, wood.scan, work.options, files, work.progress};
  RAYFIELD_ASSIGN(const ScanSurvey survey, survey_tiles(of_wood));
  tile::ScanEntry alike = wood.scan;
  alike.beam = work.scan.beam;
  return view_of(alike, survey, work.options.beam);
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
  CountedWood counted{"", voxels.tiles, voxels.echoes};  // of the scan itself: leaf areas are exactly 0
  if (wood.scan.scan_id != work.scan.scan_id) {
    counted.prefix = kWoodPrefix;
    RAYFIELD_ASSIGN(const auto view, view_of_wood(work, voxels, wood));
    if (!view) counted.echoes.reset();
    RAYFIELD_ASSIGN(counted.tiles, count_voxels(work, {wood.scan, wood.voxels, counted.prefix, view},
                                                voxels.row_segments, voxels.wood));
  }
  const std::string key = leaf_key(work, voxels, wood, counted);
  RAYFIELD_ASSIGN(ScanResults results, read_results(work, layout));

  std::optional<LeafMaps> maps;
  const auto made = [&]() -> Result<void> {
    if (maps) return {};
    RAYFIELD_ASSIGN(maps, subtract_rows(work, layout, voxels, counted, results));
    maps->values.wood_scan_id = wood.scan.scan_id, maps->values.wood_content = content_of(wood.scan);
    return {};
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get("leaf", "block", key, [&]() -> Result<tile::ArraySet> {
    RAYFIELD_CHECK(made());
    return leaf_to_arrays(maps->values, layout);
  }));
  RAYFIELD_CHECK(work.files.ensure("raster", kLeafRasterName, key, [&]() -> Result<tile::StreamedArrays> {
    RAYFIELD_CHECK(made());
    return map_to_arrays(work, *maps);
  }));
  RAYFIELD_CHECK(put_leaf_values(arrays, layout, results));
  return report_of(results);
}

}  // namespace rayfield::density
