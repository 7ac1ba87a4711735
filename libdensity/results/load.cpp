#include "rayfield/density/load.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "libdensity/ground/ground_arrays.h"
#include "libdensity/integration/raster_frame.h"
#include "libdensity/registry/layout_products.h"
#include "libdensity/registry/layout_store.h"
#include "libdensity/results/leaf_values.h"
#include "libdensity/results/results_io.h"
#include "rayfield/core/date.h"
#include "rayfield/density/registry.h"

namespace rayfield::density {
namespace {

const tile::DerivedEntry* find_derived(const std::vector<tile::DerivedEntry>& entries, std::string_view kind,
                                       std::string_view name) {
  for (const tile::DerivedEntry& entry : entries)
    if (entry.kind == kind && entry.name == name) return &entry;
  return nullptr;
}

tl::unexpected<Error> not_processed(const std::string& where) {
  return fail(ErrorCode::usage, "no results", where, "it has not been processed", "run `rayfield process` first");
}

ScanProduct describe(const tile::ScanEntry& scan) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  ScanProduct product{scan.scan_id,  scan.date, scan.name, utc_text(scan.start_time_s), utc_text(scan.end_time_s),
                      scan.ray_count};
  const tile::ScanAlignment alignment = scan.alignment.value_or(
      tile::ScanAlignment{tile::AlignmentVerdict::unaligned, Eigen::Vector3d::Constant(kUnknown)});
  const bool moved = alignment.verdict == tile::AlignmentVerdict::aligned;
  product.offset_e_m = alignment.offset_m.x(), product.offset_n_m = alignment.offset_m.y();
  product.offset_h_m = alignment.offset_m.z();
  product.yaw_mrad = scan.alignment ? 1e3 * alignment.yaw_rad : kUnknown;
  product.residual_m = moved ? alignment.residual_m : kUnknown;
  product.landmarks = alignment.landmarks;
  product.aligned = alignment.verdict != tile::AlignmentVerdict::unaligned;
  return product;
}

// Puts the leaf areas in the place of what the scan's own rays say of them, where the wood is known or estimated.
Result<void> add_leaf_values(const tile::Store& store, const tile::ScanEntry& scan, const RowLayout& layout,
                             ScanResults& results) {
  if (const tile::DerivedEntry* entry = find_derived(scan.derived, "leaf", "block")) {
    RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(*entry));
    RAYFIELD_CHECK(put_leaf_values(arrays, layout, results));
    if (results.scan.wood_scan_id == scan.scan_id) results.scan.leaf_note = "dormant: leaf area is 0 by definition";
    if (results.scan.wood_from == kWoodFromEstimate) results.scan.leaf_note = kWoodIsEstimated;
    return {};
  }
  results.scan.leaf_note = kWoodInLeafArea;
  return {};
}

// Half the width of the widest canopy, from the panels' values; posts alone give a slim panel.
double outline_half_width(const std::vector<ScanResults>& scans) {
  double width = 0.5;
  for (const ScanResults& scan : scans)
    for (const PanelValue& value : scan.panel_values)
      if (std::isfinite(value.canopy_width_m)) width = std::max(width, value.canopy_width_m);
  return width / 2;
}

// Results are stored by the registry's own numbers; products show the farm's.
std::map<int, int> shown_numbers(const RowLayout& layout) {
  std::map<int, int> shown;
  for (const Row& row : layout.rows) shown[row.number] = row.shown_number();
  return shown;
}

void show(const std::map<int, int>& shown, int& number) {
  if (const auto it = shown.find(number); it != shown.end()) number = it->second;
}

void show_farm_number(const std::map<int, int>& shown, SectionProduct& section) {
  const std::string own = std::to_string(section.row_number);
  show(shown, section.row_number);
  const std::size_t at = section.name.rfind(own);
  if (at != std::string::npos && at + own.size() == section.name.size())
    section.name.replace(at, own.size(), std::to_string(section.row_number));
}

Result<GroundModel> load_ground(const tile::Store& store, const tile::ScanEntry& scan) {
  GroundModel ground(store.config().tile_size_m);
  for (const tile::DerivedEntry& entry : scan.derived) {
    if (entry.kind != "ground") continue;
    RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(entry));
    RAYFIELD_ASSIGN(auto tile, ground_from_arrays(arrays));
    ground.set(tile.first, std::move(tile.second.nodes));
  }
  return ground;
}

}  // namespace

Result<std::vector<std::string>> select_scans(const tile::Snapshot& snapshot, const std::vector<std::string>& wanted) {
  std::vector<std::string> ids;
  for (const tile::ScanEntry& scan : snapshot.scans) {
    const bool named = std::any_of(wanted.begin(), wanted.end(),
                                   [&scan](const std::string& w) { return w == scan.scan_id || w == scan.date; });
    if (wanted.empty() || named) ids.push_back(scan.scan_id);
  }
  for (const std::string& w : wanted) {
    if (std::any_of(snapshot.scans.begin(), snapshot.scans.end(),
                    [&w](const tile::ScanEntry& scan) { return w == scan.scan_id || w == scan.date; }))
      continue;
    return fail(ErrorCode::usage, "unknown scan", w, "the store has no scan of that date or id",
                "see `rayfield status`");
  }
  return ids;
}

Result<SelectedResults> select_results(const tile::Snapshot& snapshot, const std::vector<std::string>& wanted) {
  SelectedResults selected;
  RAYFIELD_ASSIGN(selected.scan_ids, select_scans(snapshot, wanted));
  if (!wanted.empty()) return selected;
  std::vector<std::string> without;
  std::erase_if(selected.scan_ids, [&](const std::string& id) {
    const bool has_results = find_derived(snapshot.find_scan(id)->derived, "results", "block") != nullptr;
    if (!has_results) without.push_back(id);
    return !has_results;
  });
  if (selected.scan_ids.empty()) return not_processed(without.empty() ? "the block has no scan" : without.front());
  for (const std::string& id : without)
    selected.left_out.push_back(id +
                                " is left out: it has no results; `rayfield process` makes them or says why not, " +
                                "`rayfield remove` takes it out of the block");
  return selected;
}

std::vector<std::string> raster_names(const tile::ScanEntry& scan) {
  std::vector<std::string> names(std::begin(kRasterNames), std::end(kRasterNames));
  names.emplace_back(kLeafRasterName);
  std::erase_if(names, [&](const std::string& name) { return find_derived(scan.derived, "raster", name) == nullptr; });
  return names;
}

Result<BlockProducts> load_block(const tile::Store& store, const tile::Snapshot& snapshot,
                                 const std::vector<std::string>& scan_ids) {
  RAYFIELD_ASSIGN(const BlockLayout block, read_layout(store, snapshot));
  if (!block.known) return not_processed(store.folder().string());
  std::vector<ScanResults> scans;
  const tile::ScanEntry* first = nullptr;
  const std::map<int, int> shown = shown_numbers(block.layout);
  for (const tile::ScanEntry& scan : snapshot.scans) {
    if (!scan_ids.empty() && std::find(scan_ids.begin(), scan_ids.end(), scan.scan_id) == scan_ids.end()) continue;
    const tile::DerivedEntry* entry = find_derived(scan.derived, "results", "block");
    if (entry == nullptr && scan_ids.empty()) continue;
    if (entry == nullptr) return not_processed(scan.scan_id);
    RAYFIELD_ASSIGN(const tile::ArrayReader stored, store.open_derived(*entry));
    RAYFIELD_ASSIGN(const tile::ArraySet arrays, stored.read_without({kSectionValues}));
    RAYFIELD_ASSIGN(ScanResults results, results_from_arrays(arrays, block.layout, describe(scan)));
    RAYFIELD_CHECK(add_leaf_values(store, scan, block.layout, results));
    for (RowMetreProduct& metre : results.row_metres) show(shown, metre.row_number);
    scans.push_back(std::move(results));
    if (first == nullptr) first = &scan;
  }
  if (first == nullptr) return not_processed(store.folder().string());
  RAYFIELD_ASSIGN(const GroundModel ground, load_ground(store, *first));
  RAYFIELD_ASSIGN(const BlockNames names, read_names(store, snapshot));
  BlockProducts products =
      layout_products(block.layout, names.block, store.config().crs, ground, outline_half_width(scans));
  products.farm = names.farm, products.variety = names.variety;
  products.snapshot = snapshot.number;
  products.scans = std::move(scans);
  return products;
}

Result<std::vector<SectionProduct>> load_sections(const tile::Store& store, const tile::Snapshot& snapshot,
                                                  const tile::ScanEntry& scan, const std::string& name_prefix,
                                                  std::optional<int> row_number) {
  RAYFIELD_ASSIGN(const BlockLayout block, read_layout(store, snapshot));
  const tile::DerivedEntry* entry = find_derived(scan.derived, "results", "block");
  if (!block.known || entry == nullptr) return not_processed(scan.scan_id);
  RAYFIELD_ASSIGN(const tile::ArrayReader stored, store.open_derived(*entry));
  RAYFIELD_ASSIGN(const std::uint64_t count, stored.count(kSectionValues));
  RAYFIELD_ASSIGN(std::vector<SectionProduct> sections, sections_of(stored.header(), count));
  const std::map<int, int> shown = shown_numbers(block.layout);
  std::vector<SectionProduct> wanted;
  std::uint64_t first = 0;
  for (SectionProduct& section : sections) {
    const std::size_t size = static_cast<std::size_t>(section.grid.nx) * static_cast<std::size_t>(section.grid.ny);
    const std::uint64_t begin = std::exchange(first, first + size);
    show_farm_number(shown, section);
    if (section.name.rfind(name_prefix, 0) != 0 || (row_number && section.row_number != *row_number)) continue;
    section.grid.values.resize(size);
    RAYFIELD_CHECK(stored.read(kSectionValues, begin, section.grid.values));
    RAYFIELD_CHECK(check_map_values(section.grid.values, section.name));
    wanted.push_back(std::move(section));
  }
  return wanted;
}

struct StoredRaster::Impl {
  RasterProduct product;
  FittedMap fitted;
  tile::ArrayReader stored;
};

const RasterProduct& StoredRaster::product() const { return impl_->product; }

Result<void> StoredRaster::read_rows(int iy_begin, int row_count, std::span<float> values) const {
  const auto nx = static_cast<std::size_t>(impl_->product.grid.nx);
  const auto read = [&](std::uint64_t first, std::span<float> part) -> Result<void> {
    RAYFIELD_CHECK(impl_->stored.read(kRasterValues, first, part));
    return check_map_values(part, impl_->product.name);
  };
  for (int row = 0; row < row_count; ++row)
    RAYFIELD_CHECK(
        impl_->fitted.read_row(iy_begin + row, values.subspan(static_cast<std::size_t>(row) * nx, nx), read));
  return {};
}

Result<StoredRaster> open_raster(const tile::Store& store, const tile::Snapshot& snapshot, const tile::ScanEntry& scan,
                                 const std::string& name) {
  const tile::DerivedEntry* entry = find_derived(scan.derived, "raster", name);
  if (entry == nullptr) return not_processed(scan.scan_id);
  RAYFIELD_ASSIGN(tile::ArrayReader stored, store.open_derived(*entry));
  RAYFIELD_ASSIGN(const std::uint64_t count, stored.count(kRasterValues));
  RAYFIELD_ASSIGN(RasterProduct raster, raster_of(stored.header(), count));
  // A scan that was processed before the layout grew, or by an older version, has a map of another extent.
  RAYFIELD_ASSIGN(const BlockLayout block, read_layout(store, snapshot));
  if (!block.known) return not_processed(store.folder().string());
  RAYFIELD_ASSIGN(const RasterFrame frame, name == "ground" ? ground_frame(block.layout, raster.grid.cell_m)
                                                            : plan_frame(block.layout, raster.grid.cell_m));
  RAYFIELD_ASSIGN(FittedMap fitted, FittedMap::create(raster.grid, frame));
  raster.grid = Grid2<float>(frame.origin, frame.cell_m, 0, 0);
  raster.grid.nx = frame.nx, raster.grid.ny = frame.ny;
  StoredRaster out;
  out.impl_ =
      std::make_shared<StoredRaster::Impl>(StoredRaster::Impl{std::move(raster), std::move(fitted), std::move(stored)});
  return out;
}

Result<RasterProduct> load_raster(const tile::Store& store, const tile::Snapshot& snapshot, const tile::ScanEntry& scan,
                                  const std::string& name) {
  RAYFIELD_ASSIGN(const StoredRaster stored, open_raster(store, snapshot, scan, name));
  RasterProduct raster = stored.product();
  Grid2<float>& grid = raster.grid;
  grid.values.resize(static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.ny));
  RAYFIELD_CHECK(stored.read_rows(0, grid.ny, grid.values));
  return raster;
}

}  // namespace rayfield::density
