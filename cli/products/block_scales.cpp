#include "cli/products/block_scales.h"

#include <algorithm>
#include <vector>

#include "rayfield/density/load.h"
#include "rayfield/formats/scale_fit.h"

namespace rayfield::cli {
namespace {

constexpr int kRowsAtATime = 512;
constexpr const char* kPanelValue = "leaf_area_per_m";

// Leaf density is plant density less the wood: the two are compared by eye, and share a scale.
std::string scale_name(const std::string& product) { return product == "leaf_density" ? "plan_density" : product; }

Result<void> add_raster(const density::StoredRaster& raster, formats::ScaleFit& fit) {
  const Grid2<float>& grid = raster.product().grid;
  std::vector<float> values;
  for (int row = 0; row < grid.ny; row += kRowsAtATime) {
    const int count = std::min(kRowsAtATime, grid.ny - row);
    values.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(grid.nx));
    RAYFIELD_CHECK(raster.read_rows(row, count, values));
    fit.add(values);
  }
  fit.end_date();
  return {};
}

// Side views and end-on sections, of one scan at a time.
Result<void> add_sections(const tile::Store& store, const tile::Snapshot& snapshot, const tile::ScanEntry& scan,
                          std::map<std::string, formats::ScaleFit>& fits) {
  for (const char* kind : {"side_view", "end_on"}) {
    formats::ScaleFit& fit = fits.try_emplace(kind, kind).first->second;
    RAYFIELD_ASSIGN(const auto sections, density::load_sections(store, snapshot, scan, kind));
    for (const SectionProduct& section : sections) fit.add(section.grid.values);
    fit.end_date();
  }
  return {};
}

bool has_results(const tile::ScanEntry& scan) {
  return std::any_of(scan.derived.begin(), scan.derived.end(),
                     [](const tile::DerivedEntry& entry) { return entry.kind == "results"; });
}

}  // namespace

Result<BlockScales> fit_block_scales(const tile::Store& store, const tile::Snapshot& snapshot,
                                     const Progress& progress) {
  std::map<std::string, formats::ScaleFit> fits;
  std::vector<std::string> scan_ids;
  for (const tile::ScanEntry& scan : snapshot.scans) {
    if (!has_results(scan)) continue;
    scan_ids.push_back(scan.scan_id);
    for (const std::string& name : density::raster_names(scan)) {
      if (progress.cancelled())
        return fail(ErrorCode::interrupted, "interrupted", store.folder().string(), "", "run the same command again");
      RAYFIELD_ASSIGN(const density::StoredRaster raster, density::open_raster(store, snapshot, scan, name));
      RAYFIELD_CHECK(add_raster(raster, fits.try_emplace(scale_name(name), scale_name(name)).first->second));
    }
    RAYFIELD_CHECK(add_sections(store, snapshot, scan, fits));
  }
  RAYFIELD_ASSIGN(const BlockProducts block, density::load_block(store, snapshot, scan_ids));
  formats::ScaleFit& panels = fits.try_emplace(kPanelValue, kPanelValue).first->second;
  for (const ScanResults& scan : block.scans) {
    for (const PanelValue& value : scan.panel_values) panels.add(value.leaf_area_per_m);
    panels.end_date();
  }
  BlockScales scales;
  for (const auto& [name, fit] : fits) scales[name] = fit.scale();
  if (const auto plant = scales.find("plan_density"); plant != scales.end()) scales["leaf_density"] = plant->second;
  return scales;
}

}  // namespace rayfield::cli
