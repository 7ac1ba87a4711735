#include "cli/products/export_needs.h"

#include <algorithm>

#include "cli/products/export_clouds.h"
#include "rayfield/density/load.h"

namespace rayfield::cli {
namespace {

constexpr double kProgram = 128e6;

// A GeoTIFF is as large as the map in the store; head, tags and style are added.
constexpr double kTiffBytes = 6e3;
// End-on sections; side views by half metre, the plan view by cell of the map.
constexpr double kPictureBytes = 40e3, kPictureBytesPerMetre = 1.3e3, kPictureBytesPerCell = 1.4;
// An empty GeoPackage with its tables, styles and indices; a panel and a half metre on one date in each format.
constexpr double kGeoPackageBytes = 250e3, kGeoPackagePanel = 700, kGeoPackageMetre = 200;
constexpr double kCsvPanel = 350, kCsvMetre = 140, kGeoJsonPanel = 1900, kKmlPanel = 3700;
constexpr double kShapefilePanel = 500, kFlatGeobufPanel = 900, kGeoParquetPanel = 500;

}  // namespace

Result<Needs> export_needs(const tile::Store& store, const ExportOptions& options) {
  auto pinned = options.snapshot ? store.snapshot(*options.snapshot) : store.latest();
  if (!pinned) return tl::make_unexpected(std::move(pinned).error());
  RAYFIELD_ASSIGN(const auto selected, density::select_results(*pinned, options.dates));
  RAYFIELD_ASSIGN(const BlockProducts block, density::load_block(store, *pinned, selected.scan_ids));
  const auto wants = [&](const char* format) { return options.formats.count(format) > 0; };
  double bytes = wants("gpkg") ? kGeoPackageBytes : 0, cells = 0;
  for (const ScanResults& results : block.scans) {
    const tile::ScanEntry& scan = *pinned->find_scan(results.scan.scan_id);
    const auto panels = static_cast<double>(results.panel_values.size());
    const auto metres = static_cast<double>(results.row_metres.size());
    double maps = 0, map_count = 0;
    for (const tile::DerivedEntry& entry : scan.derived)
      if (entry.kind == "raster") maps += static_cast<double>(entry.file.size), ++map_count;
    RAYFIELD_ASSIGN(const density::StoredRaster raster, density::open_raster(store, *pinned, scan, "plan_density"));
    cells = std::max(cells, static_cast<double>(raster.product().grid.nx) * raster.product().grid.ny);
    if (wants("geotiff")) bytes += maps + kTiffBytes * map_count;
    if (wants("geotiff-plain")) bytes += sizeof(float) * cells * map_count;
    for (const char* format : {"png", "svg"})
      if (wants(format)) bytes += kPictureBytes + kPictureBytesPerMetre * metres + kPictureBytesPerCell * cells;
    if (wants("gpkg")) bytes += kGeoPackagePanel * panels + kGeoPackageMetre * metres;
    bytes += cloud_bytes(scan, options);
    if (wants("csv")) bytes += kCsvPanel * panels + kCsvMetre * metres;
    if (wants("geojson")) bytes += kGeoJsonPanel * panels;
    if (wants("kml")) bytes += kKmlPanel * panels;
    if (wants("flatgeobuf")) bytes += kFlatGeobufPanel * panels;
    if (wants("geoparquet")) bytes += kGeoParquetPanel * panels;
    const auto archives = static_cast<double>(options.profiles.size() + options.formats.count("shp"));
    bytes += kShapefilePanel * panels * archives;
  }
  // What is there stays until the new products take its place. A picture holds its map.
  const auto disk = static_cast<std::uint64_t>(bytes);
  return Needs{disk, disk, static_cast<std::uint64_t>(kProgram + (wants("png") ? 8 * cells : 0))};
}

}  // namespace rayfield::cli
