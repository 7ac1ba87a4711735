#include "libdensity/pipeline/scan_products.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "libdensity/estimate/integrate.h"
#include "libdensity/estimate/plan_raster.h"
#include "libdensity/estimate/raster_frame.h"
#include "libdensity/layout/polyline.h"
#include "libdensity/results/results_io.h"
#include "libdensity/scan/row_voxels.h"
#include "libdensity/scan/scan_echoes.h"
#include "libdensity/scan/stage_versions.h"
#include "libdensity/tiles/accumulate.h"
#include "libdensity/tiles/rounding.h"
#include "rayfield/density/load.h"

namespace rayfield::density {
namespace {

constexpr float kNotScanned = std::numeric_limits<float>::quiet_NaN();

struct ScanMaps {
  ScanResults results;
  std::vector<RasterProduct> rasters;
};

// One row: density, then everything that is integrated from it.
Result<void> integrate_one(const RowLayout& layout, const Row& row, const RowDensity& density,
                           const IntegrationOptions& options, ScanMaps& maps) {
  const std::vector<Panel> panels = panels_of(layout, row.number);
  std::vector<PanelValue> values = integrate_panels(density, panels, layout.spacing_m, options);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i].panel_uid = panels[i].identity.uid;
    maps.results.panel_values.push_back(std::move(values[i]));
  }
  for (RowMetreProduct& metre : row_metres(density, row.length_m(), options)) {
    metre.row_number = row.number;
    metre.position = point_at(row.centreline, metre.chainage_m).position;
    maps.results.row_metres.push_back(std::move(metre));
  }
  for (SectionProduct section : {side_view(density), end_on_section(density, row.length_m())}) {
    section.row_number = row.number;
    maps.results.sections.push_back(std::move(section));
  }
  return {};
}

// Cells between the rows that were scanned but hold no voxels are empty, not unknown: canopy there would have widened
// the voxel grids, whose width follows the hits.
void mark_lanes(const RowLayout& layout, std::span<const TileSurvey> surveys, double tile_size_m,
                std::vector<RasterProduct>& rasters) {
  std::map<tile::TileIndex, const TileSurvey*> by_tile;
  for (const TileSurvey& survey : surveys) by_tile[survey.index] = &survey;
  const auto scanned = [&](const Eigen::Vector2d& p) {
    const tile::TileIndex index{floor_int(p.x() / tile_size_m), floor_int(p.y() / tile_size_m)};
    const auto found = by_tile.find(index);
    if (found == by_tile.end()) return false;
    const Grid2<std::uint8_t>& coverage = found->second->coverage;
    const Eigen::Vector2d c = (p - coverage.origin) / coverage.cell_m;
    const int ix = floor_int(c.x()), iy = floor_int(c.y());
    return coverage.contains(ix, iy) && (coverage.at(ix, iy) & kCoverageHit) != 0;
  };
  const double reach = std::isfinite(layout.spacing_m) ? layout.spacing_m / 2 : 1.0;
  for (const Row& row : layout.rows) {
    const Grid2<float>& shape = rasters.front().grid;
    const double step = shape.cell_m / 2, length = row.length_m();
    const auto mark = [&](const Eigen::Vector2d& p) {
      const Eigen::Vector2d c = (p - shape.origin) / shape.cell_m;
      const int ix = floor_int(c.x()), iy = floor_int(c.y());
      if (!shape.contains(ix, iy) || !std::isnan(shape.at(ix, iy)) || !scanned(p)) return;
      for (RasterProduct& raster : rasters) raster.grid.at(ix, iy) = 0;
    };
    double along = 0;
    while (along <= length) {
      const LinePoint point = point_at(row.centreline, along);
      double across = -reach;
      while (across <= reach) {
        mark(point.position + across * Eigen::Vector2d(-point.direction.y(), point.direction.x()));
        across += step;
      }
      along += step;
    }
  }
}

// Heights at the centres of cells as large as the ground's nodes are apart.
Result<RasterProduct> ground_raster(const GroundModel& ground, const RowLayout& layout) {
  double cell = 0.25;
  for (const auto& [index, nodes] : ground.tiles()) cell = nodes.cell_m;
  RAYFIELD_ASSIGN(const RasterFrame frame, ground_frame(layout, cell));
  RasterProduct raster{"ground", "m", "Height of the ground",
                       Grid2<float>(frame.origin, frame.cell_m, frame.nx, frame.ny, kNotScanned)};
  for (int iy = 0; iy < frame.ny; ++iy)
    for (int ix = 0; ix < frame.nx; ++ix) {
      const Eigen::Vector2d p = raster.grid.center(ix, iy);
      if (const auto height = ground.height(p.x(), p.y())) raster.grid.at(ix, iy) = static_cast<float>(*height);
    }
  return raster;
}

Result<ScanMaps> make_maps(ScanWork& work, const RowLayout& layout, const SurveyedScan& surveyed,
                           const ScanVoxels& voxels) {
  ScanMaps maps;
  RAYFIELD_ASSIGN(RowVoxels counters, RowVoxels::open(work, "", voxels.tiles, work.options.memory_bytes / 8));
  RAYFIELD_ASSIGN(const RasterFrame frame, plan_frame(layout, work.options.plan.cell_m));
  RAYFIELD_ASSIGN(PlanRaster plan, PlanRaster::create(frame, voxels.row_segments.row_segments, work.options.plan));
  work.progress.stage(fmt::format("{}: density", work.scan.scan_id), layout.rows.size(), "rows");
  const IntegrationOptions integration = integration_with_beam(work.options.integration, work.scan, voxels.echoes);
  for (const Row& row : layout.rows) {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    if (!counters.has_row(row.number)) continue;
    RAYFIELD_ASSIGN(const RowDensity density, counters.density(row.number, voxels.row_segments, voxels.wood,
                                                               work.options.estimator, voxels.echoes));
    maps.results.element_area_m2 = density.leaf_size_m2;
    RAYFIELD_CHECK(integrate_one(layout, row, density, integration, maps));
    plan.add(density);
    work.progress.advance(1);
  }
  maps.rasters = plan.finish();
  mark_lanes(layout, surveyed.surveys, work.tile_size_m(), maps.rasters);
  RAYFIELD_ASSIGN(RasterProduct heights, ground_raster(surveyed.ground, layout));
  maps.rasters.push_back(std::move(heights));
  return maps;
}

}  // namespace

Result<ScanResults> integrate_scan(ScanWork& work, const RowLayout& layout, const SurveyedScan& surveyed,
                                   const ScanVoxels& voxels) {
  KeyBuilder builder("results", kResultsVersion);
  builder.add(option_numbers(work.options.estimator));
  builder.add(option_numbers(integration_with_beam(work.options.integration, work.scan, voxels.echoes)));
  if (voxels.echoes) builder.add(model_numbers(voxels.echoes));
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
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get("results", "block", key, [&]() -> Result<tile::ArraySet> {
    RAYFIELD_CHECK(made());
    return results_to_arrays(maps->results, layout);
  }));
  for (const char* name : kRasterNames) {
    RAYFIELD_CHECK(work.files.get("raster", name, key, [&]() -> Result<tile::ArraySet> {
      RAYFIELD_CHECK(made());
      for (const RasterProduct& raster : maps->rasters)
        if (raster.name == name) return raster_to_arrays(raster);
      return fail(ErrorCode::internal, "cannot make raster", name, "no such raster", "please report this");
    }));
  }
  return results_from_arrays(arrays, layout, {});
}

}  // namespace rayfield::density
