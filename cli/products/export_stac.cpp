#include "cli/products/export_stac.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "rayfield/core/date.h"
#include "rayfield/density/load.h"
#include "rayfield/formats/stac.h"

namespace rayfield::cli {
namespace {

// The Item of a scan, with the maps that an export writes of it.
Result<formats::StacItem> describe_item(const tile::Store& store, const tile::Snapshot& snapshot,
                                        const tile::ScanEntry& scan, const std::string& block) {
  formats::StacItem item;
  item.file_name = fmt::format("{}_{}_stac.json", block, scan.scan_id);
  item.scan.scan_id = scan.scan_id;
  item.scan.scan_date = scan.date;
  item.scan.name = scan.name;
  item.scan.start_utc = utc_text(scan.start_time_s);
  item.scan.end_utc = utc_text(scan.end_time_s);
  for (const std::string& name : density::raster_names(scan)) {
    RAYFIELD_ASSIGN(const density::StoredRaster raster, density::open_raster(store, snapshot, scan, name));
    const RasterProduct& product = raster.product();
    item.assets.push_back({name, product.unit, product.description,
                           fmt::format("{}_{}_{}.tif", block, scan.scan_id, name), product.grid.origin,
                           product.grid.cell_m, product.grid.nx, product.grid.ny});
  }
  return item;
}

}  // namespace

Result<void> export_stac(const tile::Store& store, const tile::Snapshot& snapshot, const BlockProducts& block,
                         const std::string& source, ExportFolder& folder) {
  const std::string collection = block.block + "_collection.json";
  std::vector<formats::StacItem> items;
  for (const tile::ScanEntry& scan : snapshot.scans) {
    if (density::raster_names(scan).empty()) continue;
    RAYFIELD_ASSIGN(formats::StacItem item, describe_item(store, snapshot, scan, block.block));
    const bool exported = std::any_of(block.scans.begin(), block.scans.end(),
                                      [&](const ScanResults& results) { return results.scan.scan_id == scan.scan_id; });
    if (!exported && !folder.has(item.file_name)) continue;
    if (exported && folder.wants(item.file_name, source))
      RAYFIELD_CHECK(formats::write_stac_item(block, item, collection, folder.path(item.file_name)));
    items.push_back(std::move(item));
  }
  if (items.empty() || !folder.wants(collection, source)) return {};
  return formats::write_stac_collection(block, items, folder.path(collection));
}

}  // namespace rayfield::cli
