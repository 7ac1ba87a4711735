#include "cli/products/export_block.h"

#include <fmt/core.h>

#include <optional>

#include "cli/products/block_scales.h"
#include "cli/products/exchange_products.h"
#include "cli/products/export_clouds.h"
#include "cli/products/export_folder.h"
#include "cli/products/export_pictures.h"
#include "cli/products/export_source.h"
#include "cli/products/export_stac.h"
#include "rayfield/density/load.h"
#include "rayfield/formats/formats.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

// The block's layout, on whose frame all rasters lie.
std::string layout_source(const tile::Snapshot& snapshot) {
  Source source("layout");
  for (const tile::DerivedEntry& entry : snapshot.registry) source.add(entry.file.sha256);
  return source.hex();
}

// Of a raster by its name.
const char* product_unit(std::string_view name) {
  return name.starts_with("plan") || name.starts_with("leaf") ? "m2/m2" : "m";
}

// The whole export: equal ones are of one snapshot, and of the same scans in the same formats.
std::string content_of(const tile::Snapshot& snapshot, const std::vector<std::string>& scan_ids,
                       const ExportOptions& options) {
  Source source("export");
  source.add(std::to_string(snapshot.number)).add(layout_source(snapshot));
  for (const std::string& format : options.formats) source.add(format);
  for (const std::string& profile : options.profiles) source.add("profile " + profile);
  for (const std::string& id : scan_ids) {
    source.add(id);
    for (const tile::DerivedEntry& entry : snapshot.find_scan(id)->derived)
      if (entry.kind == "results" || entry.kind == "leaf" || entry.kind == "raster") source.add(entry.file.sha256);
  }
  return source.hex();
}

Result<void> write_map(const density::StoredRaster& raster, const std::string& crs, const std::string& path,
                       const formats::GeoTiffOptions& options) {
  const RasterProduct& product = raster.product();
  const formats::RasterLayout layout{product.name,        product.unit,    product.description, product.grid.origin,
                                     product.grid.cell_m, product.grid.nx, product.grid.ny};
  const auto read = [&](int iy_begin, int row_count, std::span<float> values) {
    return raster.read_rows(iy_begin, row_count, values);
  };
  return formats::write_cog(layout, read, crs, path, options);
}

// What the rasters of a scan are written with.
struct MapExport {
  const tile::Store& store;
  const tile::Snapshot& snapshot;
  const BlockProducts& block;
  const BlockScales& scales;
  const ExportOptions& options;
  std::string layout;  // digest of the rows' layout

  bool wants(const char* format) const { return options.formats.count(format) > 0; }
};

// One raster as the GeoTIFFs that are wanted, and their style: a raster stays as it is where only the scale has
// changed.
Result<void> export_raster(const MapExport& maps, const tile::ScanEntry& scan, const std::string& name,
                           ExportFolder& folder) {
  const std::string stem = fmt::format("{}_{}_{}", maps.block.block, scan.scan_id, name);
  const std::string values = derived_sha256(scan, "raster", name);
  const auto source = [&](const char* format) {
    return Source(format).add(maps.block.crs).add(maps.layout).add(values).hex();
  };
  const formats::ColorScale& scale = maps.scales.at(name);
  if (maps.wants("geotiff") && folder.wants(stem + ".qml", scale_source(scale)))
    RAYFIELD_CHECK(formats::write_raster_style(scale, product_unit(name), folder.path(stem + ".qml")));
  const bool tiff = maps.wants("geotiff") && folder.wants(stem + ".tif", source("geotiff"));
  const bool plain = maps.wants("geotiff-plain") && folder.wants(stem + "_plain.tif", source("geotiff-plain"));
  if (!tiff && !plain) return {};
  RAYFIELD_ASSIGN(const density::StoredRaster raster, density::open_raster(maps.store, maps.snapshot, scan, name));
  formats::GeoTiffOptions write;
  write.write_style = false;
  write.metadata = {{"scan_id", scan.scan_id},
                    {"scan_date", scan.date},
                    {"snapshot", std::to_string(maps.block.snapshot)},
                    {"source_sha256", values}};
  if (tiff) RAYFIELD_CHECK(write_map(raster, maps.block.crs, folder.path(stem + ".tif"), write));
  write.profile = formats::GeoTiffOptions::Profile::plain;
  if (plain) RAYFIELD_CHECK(write_map(raster, maps.block.crs, folder.path(stem + "_plain.tif"), write));
  return {};
}

Result<void> export_rasters(const MapExport& maps, const tile::ScanEntry& scan, ExportFolder& folder) {
  for (const std::string& name : density::raster_names(scan)) RAYFIELD_CHECK(export_raster(maps, scan, name, folder));
  return {};
}

// What the project in the GeoPackage shows: maps that this export writes, or that lie in the folder already.
formats::GeoPackageOptions geopackage_options(const tile::Snapshot& snapshot, const BlockProducts& block,
                                              const BlockScales& scales, const ExportFolder& folder,
                                              const ExportOptions& options) {
  formats::GeoPackageOptions write;
  write.panel_scale = scales.at("leaf_area_per_m");
  write.project = true;
  for (const ScanResults& results : block.scans) {
    const std::string& scan_id = results.scan.scan_id;
    for (const std::string& name : density::raster_names(*snapshot.find_scan(scan_id))) {
      const std::string file = fmt::format("{}_{}_{}.tif", block.block, scan_id, name);
      if (options.formats.count("geotiff") == 0 && !folder.has(file)) continue;
      write.maps.push_back({scan_id, name, product_unit(name), file, scales.at(name)});
    }
  }
  return write;
}

// Products of all dates in one file, and of single dates.
Result<void> export_tables(const BlockProducts& block, const formats::GeoPackageOptions& write,
                           const std::string& content, const std::optional<std::string>& carry_over_from,
                           const ExportOptions& options, ExportFolder& folder) {
  if (const std::string name = block.block + ".gpkg";
      options.formats.count("gpkg") > 0 && folder.wants(name, content)) {
    RAYFIELD_CHECK(formats::write_geopackage(block, folder.path(name), write));
    if (carry_over_from) RAYFIELD_CHECK(formats::carry_over(*carry_over_from, folder.path(name)));
  }
  return export_exchange(block, content, options, folder);
}

// Whether the GeoPackage that is there may be replaced, and if it holds something that users added: its path.
Result<std::optional<std::string>> additions_to_keep(const tile::Store& store, const BlockProducts& block,
                                                     const fs::path& folder, const ExportOptions& options) {
  const std::string path = (folder / (block.block + ".gpkg")).string();
  if (options.formats.count("gpkg") == 0) return std::nullopt;
  RAYFIELD_CHECK(formats::check_not_in_use(path));
  if (options.overwrite) return std::nullopt;
  RAYFIELD_ASSIGN(const tile::Snapshot latest, store.latest());
  std::vector<std::string> scans_of_store;
  for (const tile::ScanEntry& scan : latest.scans) scans_of_store.push_back(scan.scan_id);
  RAYFIELD_CHECK(formats::check_replaceable(block, scans_of_store, path));
  RAYFIELD_ASSIGN(const auto existing, formats::inspect_geopackage(path));
  if (existing && existing->has_additions) return path;
  return std::nullopt;
}

}  // namespace

Result<ExportReport> export_block(const tile::Store& store, const fs::path& folder, const ExportOptions& options,
                                  Progress& progress) {
  RAYFIELD_CHECK(check_exchange(options));
  auto pinned = options.snapshot ? store.snapshot(*options.snapshot) : store.latest();
  if (!pinned) return tl::make_unexpected(std::move(pinned).error());
  const tile::Snapshot& snapshot = *pinned;
  RAYFIELD_ASSIGN(const auto selected, density::select_results(snapshot, options.dates));
  const std::vector<std::string>& scan_ids = selected.scan_ids;
  for (const std::string& line : selected.left_out) progress.warn(line);
  const std::string content = content_of(snapshot, scan_ids, options);
  RAYFIELD_ASSIGN(ExportFolder output, ExportFolder::open(folder, store.block_name(), options.keep_unchanged));
  if (output.holds(content)) return ExportReport{snapshot.number, output.products(), 0};
  RAYFIELD_ASSIGN(const BlockProducts block, density::load_block(store, snapshot, scan_ids));
  RAYFIELD_ASSIGN(const auto carry_over_from, additions_to_keep(store, block, folder, options));

  RAYFIELD_ASSIGN(const BlockScales scales, fit_block_scales(store, snapshot, progress));

  progress.stage("export", scan_ids.size() + 1, "steps");
  const auto write = geopackage_options(snapshot, block, scales, output, options);
  RAYFIELD_CHECK(export_tables(block, write, content, carry_over_from, options, output));
  progress.advance(1);
  const MapExport maps{store, snapshot, block, scales, options, layout_source(snapshot)};
  const PictureExport pictures{store, snapshot, block, scales, options, maps.layout, reference_name(block.crs)};
  for (const ScanResults& results : block.scans) {
    if (progress.cancelled())
      return fail(ErrorCode::interrupted, "interrupted", folder.string(), "", "run the same command again");
    const tile::ScanEntry& scan = *snapshot.find_scan(results.scan.scan_id);
    RAYFIELD_CHECK(export_rasters(maps, scan, output));
    RAYFIELD_CHECK(export_pictures(pictures, results, output));
    progress.advance(1);
  }
  if (wants_clouds(options)) RAYFIELD_CHECK(export_clouds(store, snapshot, block, options, progress, output));
  if (options.formats.count("geotiff") > 0) RAYFIELD_CHECK(export_stac(store, snapshot, block, content, output));
  RAYFIELD_CHECK(output.publish(snapshot.number, content));
  return ExportReport{snapshot.number, output.products(), output.written_count()};
}

}  // namespace rayfield::cli
