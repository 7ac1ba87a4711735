#include "libdensity/leaf/leaf_maps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "libdensity/integration/descriptors.h"
#include "libdensity/integration/leaf_area.h"
#include "libdensity/integration/raster_frame.h"
#include "libdensity/layout/polyline.h"
#include "libdensity/results/results_io.h"
#include "libdensity/results/stored_descriptors.h"
#include "libdensity/scan/row_voxels.h"
#include "libdensity/tiles/accumulate.h"
#include "rayfield/core/parallel.h"
#include "rayfield/density/load.h"

namespace rayfield::density {
namespace {

struct RowLeaves {
  std::optional<RowDensity> leaf;
  std::vector<PanelValue> panels;  // of the results, with leaf areas and the descriptors of leaves
  std::vector<RowMetreProduct> metres;
  std::vector<double> profile;  // band by band, panel by panel
};

// What lines meet of leaves alone, inside the outline of leaves and wood.
void describe_leaves(const RowDensity& leaf, std::span<const Panel> panels, double length_m,
                     std::span<const StretchOutline> outline, const DescriptorSettings& settings, RowLeaves& out) {
  const RowLines lines(leaf, length_m, outline, settings);
  lines.describe_panels(panels, out.panels);
  lines.describe_metres(out.metres);
  for (const auto& bands : vertical_profiles(leaf, panels, settings.options.profile_band_m))
    for (const BandAreas& band : bands) out.profile.push_back(band.canopy_area_m2);
}

// Where too little was seen, nothing is said of leaves.
void forget_leaves(CanopyDescriptors& descriptors) {
  for (const auto& [name, member] : kLeafDescriptors) descriptors.*member = CanopyDescriptors::kUndefined;
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

// Half metres of a row and what its lines meet.
Result<void> complete_row(const Row& row, std::span<const Panel> panels, const ScanResults& results,
                          const DescriptorSettings& settings, RowLeaves& out) {
  for (const RowMetreProduct& metre : results.row_metres)
    if (metre.row_number == row.number) out.metres.push_back(metre);
  const double length_m = row.length_m();
  const std::vector<double> areas = leaf_of_metres(*out.leaf, length_m, settings.metre_step_m);
  if (areas.size() != out.metres.size()) return not_of_this_layout(row.number);
  describe_leaves(*out.leaf, panels, length_m, outline_of(results.row_metres, row.number), settings, out);
  for (std::size_t k = 0; k < areas.size(); ++k) {
    RowMetreProduct& metre = out.metres[k];
    metre.leaf_area_per_m = std::isnan(metre.plant_area_per_m) ? CanopyDescriptors::kUndefined : areas[k];
    if (std::isnan(metre.leaf_area_per_m)) forget_leaves(metre.descriptors);
  }
  return {};
}

void append(RowLeaves& row, LeafValues& values) {
  const std::size_t bands = row.panels.empty() ? 0 : row.profile.size() / row.panels.size();
  for (std::size_t k = 0; k < row.panels.size(); ++k) {
    if (std::isfinite(row.panels[k].leaf_area_m2)) continue;
    forget_leaves(row.panels[k].descriptors);
    const auto profile = std::span(row.profile).subspan(k * bands, bands);
    std::fill(profile.begin(), profile.end(), CanopyDescriptors::kUndefined);
  }
  values.panels.insert(values.panels.end(), row.panels.begin(), row.panels.end());
  values.metres.insert(values.metres.end(), row.metres.begin(), row.metres.end());
  values.profile.insert(values.profile.end(), row.profile.begin(), row.profile.end());
}

}  // namespace

Result<LeafMaps> make_leaf_maps(ScanWork& work, std::span<const Row* const> rows, const RowLayout& layout,
                                const ScanVoxels& voxels, const ScanResults& results, const LeavesOfRow& leaves_of) {
  RAYFIELD_ASSIGN(const RasterFrame frame, plan_frame(layout, work.options.plan.cell_m));
  RAYFIELD_ASSIGN(PlanRaster plan, PlanRaster::create(frame, voxels.row_segments.row_segments, work.options.plan,
                                                      work.memory.maps_bytes, work.files.scratch_folder()));
  LeafMaps maps{{}, std::move(plan)};
  work.progress.stage(fmt::format("{}: leaves", work.scan.scan_id), layout.rows.size(), "rows");
  RAYFIELD_ASSIGN(const int workers, rows_in_hand(work, voxels.row_segments, voxels.echoes.has_value()));
  std::vector<RowLeaves> done(rows.size());
  const auto make = [&](std::size_t i, int) -> Result<void> {
    RAYFIELD_CHECK(check_cancelled(work.progress));
    const std::vector<Panel> panels = panels_of(layout, rows[i]->number);
    RAYFIELD_ASSIGN(done[i].panels, values_of(results.panel_values, panels, rows[i]->number));
    RAYFIELD_ASSIGN(done[i].leaf, leaves_of(*rows[i], panels, done[i].panels));
    return complete_row(*rows[i], panels, results, descriptor_settings(work.options, work.voxels.leaf_angles), done[i]);
  };
  const auto take = [&](std::size_t i) -> Result<void> {
    RowLeaves row = std::exchange(done[i], {});
    append(row, maps.values);
    RAYFIELD_CHECK(maps.plan.add(*row.leaf));
    work.progress.advance(1);
    return {};
  };
  RAYFIELD_CHECK(parallel_ordered(rows.size(), workers, static_cast<std::size_t>(workers), make, take));
  return maps;
}

// Lanes have no voxels; where there are no plants there are no leaves.
Result<tile::StreamedArrays> leaf_map_to_arrays(ScanWork& work, LeafMaps& maps) {
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

}  // namespace rayfield::density
