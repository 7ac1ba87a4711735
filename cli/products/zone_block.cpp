#include "cli/products/zone_block.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "cli/console/output_paths.h"
#include "cli/products/block_scales.h"
#include "cli/products/exchange_products.h"
#include "cli/products/export_pictures.h"
#include "rayfield/density/load.h"
#include "rayfield/formats/formats.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWhat = "cannot make zones";

// The scan that is asked for, or the newest.
Result<std::string> scan_of(const tile::Snapshot& snapshot, const std::string& date) {
  if (date.empty() || snapshot.find_scan(date) != nullptr) {
    if (!date.empty()) return date;
    RAYFIELD_ASSIGN(const auto selected, density::select_results(snapshot, {}));
    const std::vector<std::string>& all = selected.scan_ids;
    const auto newest = std::max_element(all.begin(), all.end(), [&](const std::string& a, const std::string& b) {
      return snapshot.find_scan(a)->date < snapshot.find_scan(b)->date;
    });
    if (newest != all.end()) return *newest;
    return fail(ErrorCode::usage, kWhat, "", "the store has no scan", "add one with `rayfield add`");
  }
  RAYFIELD_ASSIGN(const auto ids, density::select_scans(snapshot, {date}));
  if (ids.size() == 1) return ids.front();
  return fail(ErrorCode::usage, kWhat, date, "the store has several scans of that date",
              fmt::format("give one of them, such as {}", ids.front()));
}

// What the zones are made of, with its unit and meaning.
Result<std::vector<density::ZoneSample>> take_samples(const tile::Store& store, const tile::Snapshot& snapshot,
                                                      const BlockProducts& block, const ZoneRequest& request,
                                                      ZoneMap& map) {
  map.value = request.of;
  if (request.of == "plan_density") {
    map.unit = "m2/m2", map.meaning = "one-sided area of the canopy per ground area";
    const tile::ScanEntry& scan = *snapshot.find_scan(map.scan.scan_id);
    RAYFIELD_ASSIGN(const RasterProduct raster, density::load_raster(store, snapshot, scan, request.of));
    return density::map_samples(raster.grid, request.options.cell_m);
  }
  map.unit = "m2/m", map.meaning = "one-sided leaf area per metre of row";
  return density::row_samples(block.scans.front());
}

// The map of canopy density with the zones shaded on it.
Result<void> draw_map(const tile::Store& store, const tile::Snapshot& snapshot, const ZoneMap& map,
                      const std::array<std::string, 2>& paths, Progress& progress) {
  const tile::ScanEntry& scan = *snapshot.find_scan(map.scan.scan_id);
  RAYFIELD_ASSIGN(const BlockProducts block, density::load_block(store, snapshot, {scan.scan_id}));
  RAYFIELD_ASSIGN(const BlockScales scales, fit_block_scales(store, snapshot, progress));
  RAYFIELD_ASSIGN(const RasterProduct raster, density::load_raster(store, snapshot, scan, "plan_density"));
  formats::PictureOptions picture;
  picture.scale = scales.at("plan_density");
  picture.title = fmt::format("{}, management zones", map.block);
  picture.subtitle = map.scan.scan_date + "   " + reference_name(map.crs);
  for (const std::string& path : paths)
    RAYFIELD_CHECK(
        formats::write_plan_picture(raster, formats::zone_overlay(block, map.zones, map.unit), path, picture));
  return {};
}

Result<ZoneMap> make_zones(const tile::Store& store, const tile::Snapshot& snapshot, const ZoneRequest& request) {
  RAYFIELD_ASSIGN(const std::string scan_id, scan_of(snapshot, request.date));
  RAYFIELD_ASSIGN(const BlockProducts block, density::load_block(store, snapshot, {scan_id}));
  ZoneMap map;
  map.block = block.block, map.farm = block.farm, map.variety = block.variety, map.crs = block.crs;
  map.snapshot = block.snapshot, map.scan = block.scans.front().scan;
  RAYFIELD_ASSIGN(const auto all_samples, take_samples(store, snapshot, block, request, map));
  const auto bands = density::row_bands(block.rows, map.scan.scan_date);
  const std::vector<density::ZoneSample> samples = density::samples_on(bands, all_samples);
  double margin_m = 2 * request.options.cell_m;
  for (const RowProduct& row : block.rows) margin_m = std::max(margin_m, row.spacing_m);
  RAYFIELD_ASSIGN(const density::ValueSurface surface,
                  density::value_surface(samples, margin_m + 2 * request.options.cell_m, request.options));
  RAYFIELD_ASSIGN(map.zones, formats::draw_zones(surface.values, surface.breaks, bands,
                                                 density::smallest_zone_m2(bands, request.options)));
  map.explained = density::measure_zones(samples, map.zones);
  for (const ManagementZone& zone : map.zones) map.area_m2 += zone.area_m2;
  return map;
}

// Zones on their own, and with rates also what a machine applies.
Result<void> write_products(const tile::Store& store, const tile::Snapshot& snapshot, const ZoneMap& map,
                            const std::optional<Prescription>& rates, const ZoneRequest& request, ZoneReport& report,
                            Progress& progress) {
  const std::string stem = fmt::format("{}_{}_", map.block, map.scan.scan_id), last = stem + "zones.gpkg";
  RAYFIELD_ASSIGN(const OutputFolder made, OutputFolder::make(*request.folder));
  RAYFIELD_ASSIGN(const formats::ProductFolder folder,
                  formats::ProductFolder::create(request.folder->string(), last, kWhat));
  const auto path = [&](const std::string& ending) {
    report.files.push_back(*request.folder / (stem + ending));
    return folder.path(stem + ending);
  };
  const formats::FarmProfile& plain = *formats::find_farm_profile("plain");
  RAYFIELD_CHECK(formats::write_zones_geojson(map, path("zones.geojson")));
  RAYFIELD_CHECK(formats::write_zones_shapefile(map, {}, plain, path("zones.shp.zip")));
  if (rates) {
    RAYFIELD_CHECK(formats::write_zones_shapefile(map, rates, plain, path("prescription.shp.zip")));
    RAYFIELD_CHECK(formats::write_isoxml(map, *rates, path("taskdata.zip")));
  }
  for (const std::string& name : request.profiles)
    RAYFIELD_CHECK(
        formats::write_zones_shapefile(map, rates, *formats::find_farm_profile(name),
                                       path(fmt::format("{}_{}.zip", rates ? "prescription" : "zones", name))));
  RAYFIELD_CHECK(draw_map(store, snapshot, map, {path("zones.png"), path("zones.svg")}, progress));
  RAYFIELD_CHECK(formats::write_zones_geopackage(map, path("zones.gpkg")));
  return folder.publish();
}

}  // namespace

Result<ZoneReport> zone_block(const tile::Store& store, const ZoneRequest& request, Progress& progress) {
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  progress.stage("zones", 2, "steps");
  ZoneReport report;
  RAYFIELD_ASSIGN(report.map, make_zones(store, snapshot, request));
  progress.advance(1);
  std::optional<Prescription> rates;
  if (request.rates) {
    const auto& [file, unit, product] = *request.rates;
    RAYFIELD_ASSIGN(rates, formats::read_rates(file, unit, product, report.map.zones));
  }
  if (request.folder) RAYFIELD_CHECK(write_products(store, snapshot, report.map, rates, request, report, progress));
  progress.advance(1);
  return report;
}

}  // namespace rayfield::cli
