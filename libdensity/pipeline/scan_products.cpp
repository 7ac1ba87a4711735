#include "libdensity/pipeline/scan_products.h"

#include <fmt/core.h>

#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "libdensity/echoes/echo_model_arrays.h"
#include "libdensity/integration/descriptors.h"
#include "libdensity/integration/integrate.h"
#include "libdensity/integration/plan_raster.h"
#include "libdensity/integration/raster_frame.h"
#include "libdensity/layout/polyline.h"
#include "libdensity/pipeline/scan_maps.h"
#include "libdensity/results/results_io.h"
#include "libdensity/results/section_values.h"
#include "libdensity/scan/row_voxels.h"
#include "libdensity/scan/scan_echoes.h"
#include "libdensity/scan/scan_sides.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/accumulate.h"
#include "rayfield/core/parallel.h"
#include "rayfield/density/load.h"

namespace rayfield::density {
namespace {

struct ScanMaps {
  ScanResults results;     // sections without their values
  SectionValues sections;  // those
  PlanRaster plan;
};

// What is integrated from one row's density.
struct RowProducts {
  std::vector<PanelValue> panels;
  std::vector<RowMetreProduct> metres;
  std::vector<SectionProduct> sections;
  std::vector<PanelProfileBand> profile;
};

// What the canopy of leaves and wood is like; leaf_products.cpp puts leaves alone in its place where wood is known.
void describe_row(const RowDensity& density, std::span<const Panel> panels, double length_m,
                  const DescriptorSettings& settings, RowProducts& out) {
  std::vector<StretchOutline> outline = canopy_outline(density, length_m, settings);
  for (std::size_t i = 0; i < outline.size(); ++i)
    if (std::isnan(out.metres[i].plant_area_per_m)) outline[i] = {};  // too little was seen for a gap, too
  put_outline(outline, out.metres);
  const RowLines lines(density, length_m, outline, settings);
  lines.describe_panels(panels, out.panels);
  lines.describe_metres(out.metres);
  const auto profiles = vertical_profiles(density, panels, settings.options.profile_band_m);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const bool known = std::isfinite(out.panels[i].plant_area_m2);
    for (const BandAreas& band : profiles[i])
      out.profile.push_back({panels[i].identity.uid,
                             {},
                             {},
                             band.low_m,
                             band.high_m,
                             known ? band.plant_area_m2 : CanopyDescriptors::kUndefined,
                             known ? band.canopy_area_m2 : CanopyDescriptors::kUndefined});
  }
}

RowProducts integrate_row(const RowLayout& layout, const Row& row, const RowDensity& density,
                          const IntegrationOptions& options, const DescriptorSettings& settings) {
  RowProducts out;
  const std::vector<Panel> panels = panels_of(layout, row.number);
  out.panels = integrate_panels(density, panels, layout.spacing_m, options);
  for (std::size_t i = 0; i < out.panels.size(); ++i) out.panels[i].panel_uid = panels[i].identity.uid;
  out.metres = row_metres(density, row.length_m(), options);
  describe_row(density, panels, row.length_m(), settings, out);
  for (RowMetreProduct& metre : out.metres) {
    metre.row_number = row.number;
    metre.position = point_at(row.centreline, metre.chainage_m).position;
  }
  out.sections = {side_view(density), end_on_section(density, row.length_m())};
  for (SectionProduct& section : out.sections) section.row_number = row.number;
  return out;
}

Result<void> append(RowProducts row, ScanMaps& maps) {
  ScanResults& results = maps.results;
  std::move(row.panels.begin(), row.panels.end(), std::back_inserter(results.panel_values));
  std::move(row.metres.begin(), row.metres.end(), std::back_inserter(results.row_metres));
  std::move(row.profile.begin(), row.profile.end(), std::back_inserter(results.profile));
  for (SectionProduct& section : row.sections) {
    RAYFIELD_CHECK(maps.sections.take(section));
    results.sections.push_back(std::move(section));
  }
  return {};
}

// Rows are estimated in parallel, as many as have room, and brought together in their order.
Result<void> integrate_rows(ScanWork& work, const RowLayout& layout, const ScanVoxels& voxels, ScanMaps& maps) {
  RAYFIELD_ASSIGN(RowVoxels counters, RowVoxels::open(work, "", voxels.tiles, work.memory.tiles_bytes));
  std::vector<const Row*> rows;
  for (const Row& row : layout.rows)
    if (counters.has_row(row.number)) rows.push_back(&row);
  work.progress.stage(fmt::format("{}: density", work.scan.scan_id), layout.rows.size(), "rows");
  const IntegrationOptions integration = integration_of_scan(work, voxels);
  const DescriptorSettings settings = descriptor_settings(work.options, work.voxels.leaf_angles);
  maps.results.scan.fruit_zone_low_m = settings.options.fruit_zone_low_m;
  maps.results.scan.fruit_zone_high_m = settings.options.fruit_zone_high_m;
  RAYFIELD_ASSIGN(const int workers, rows_in_hand(work, voxels.row_segments, voxels.echoes.has_value()));
  struct Done {
    std::optional<RowDensity> density;
    RowProducts products;
  };
  std::vector<Done> done(rows.size());
  const auto estimate = [&](std::size_t i, int) -> Result<void> {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    RAYFIELD_ASSIGN(done[i].density, counters.density(rows[i]->number, voxels.row_segments, voxels.wood,
                                                      work.options.estimator, voxels.echoes));
    done[i].products =
        integrate_row(layout, *rows[i], *done[i].density,
                      integration_of_row(integration, work.scan, rows[i]->number, voxels.rows_from_one_side), settings);
    return {};
  };
  const auto take = [&](std::size_t i) -> Result<void> {
    const Done row = std::exchange(done[i], {});
    maps.results.leaf_size_m2 = row.density->leaf_size_m2;
    RAYFIELD_CHECK(append(row.products, maps));
    RAYFIELD_CHECK(maps.plan.add(*row.density));
    work.progress.advance(1);
    return {};
  };
  return parallel_ordered(rows.size(), workers, static_cast<std::size_t>(workers), estimate, take);
}

Result<ScanMaps> make_maps(ScanWork& work, const RowLayout& layout, const SurveyedScan& surveyed,
                           const ScanVoxels& voxels) {
  RAYFIELD_ASSIGN(const RasterFrame frame, plan_frame(layout, work.options.plan.cell_m));
  const std::filesystem::path folder = work.files.scratch_folder();
  RAYFIELD_ASSIGN(PlanRaster plan, PlanRaster::create(frame, voxels.row_segments.row_segments, work.options.plan,
                                                      work.memory.maps_bytes, folder));
  SectionValues sections(folder);
  ScanMaps maps{{}, std::move(sections), std::move(plan)};
  RAYFIELD_CHECK(integrate_rows(work, layout, voxels, maps));
  RAYFIELD_CHECK(mark_lanes(layout, surveyed.survey, work.tile_size_m(), frame.cell_m, maps.plan));
  return maps;
}

// The values of one map, made as they are read.
Result<tile::StreamedArrays> map_to_arrays(const std::string& name, ScanMaps& maps, const GroundModel& ground,
                                           const RowLayout& layout) {
  const std::vector<RasterProduct> planned = maps.plan.maps();
  for (std::size_t map = 0; map < planned.size(); ++map) {
    if (planned[map].name != name) continue;
    const Grid2<float>& grid = planned[map].grid;
    return raster_to_arrays(planned[map], {static_cast<std::uint64_t>(grid.nx) * static_cast<std::uint64_t>(grid.ny),
                                           [&maps, map](std::uint64_t first, std::span<float> values) {
                                             return maps.plan.read(map, first, values);
                                           }});
  }
  RAYFIELD_ASSIGN(GroundMap heights, ground_map(ground, layout));
  if (heights.raster.name != name)
    return fail(ErrorCode::internal, "cannot make raster", name, "no such raster", "please report this");
  return raster_to_arrays(heights.raster, std::move(heights.values));
}

}  // namespace

Result<ScanResults> integrate_scan(ScanWork& work, const RowLayout& layout, const SurveyedScan& surveyed,
                                   const ScanVoxels& voxels) {
  KeyBuilder builder("results", kResultsVersion);
  builder.add(option_numbers(work.options.estimator));
  builder.add(option_numbers(integration_of_scan(work, voxels)));
  builder.add(option_numbers(work.options.descriptors)).add(option_numbers(work.voxels.leaf_angles));
  if (voxels.echoes) builder.add(model_numbers(voxels.echoes));
  builder.add(std::vector<double>(voxels.rows_from_one_side.begin(), voxels.rows_from_one_side.end()));
  builder.add(option_numbers(work.options.plan)).add(work.layout_key).add(work.files.sha256("stretches", "block"));
  for (const tile::TileIndex index : voxels.tiles) builder.add(work.files.sha256("voxels", tile_name(index)));
  for (const tile::TileEntry& entry : work.scan.tiles)
    builder.add(work.files.sha256("ground", tile_name(entry.index)))
        .add(work.files.sha256("survey", tile_name(entry.index)));
  const std::string key = builder.hex();

  std::optional<ScanMaps> maps;
  const auto made = [&]() -> Result<void> {
    if (maps) return {};
    RAYFIELD_ASSIGN(maps, make_maps(work, layout, surveyed, voxels));
    return {};
  };
  RAYFIELD_CHECK(work.files.ensure("results", "block", key, [&]() -> Result<tile::StreamedArrays> {
    RAYFIELD_CHECK(made());
    return results_to_arrays(maps->results, layout, maps->sections.source());
  }));
  for (const char* name : kRasterNames) {
    RAYFIELD_CHECK(work.files.ensure("raster", name, key, [&]() -> Result<tile::StreamedArrays> {
      RAYFIELD_CHECK(made());
      return map_to_arrays(name, *maps, surveyed.ground, layout);
    }));
  }
  return read_results(work, layout);
}

}  // namespace rayfield::density
