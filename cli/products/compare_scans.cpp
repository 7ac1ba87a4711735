#include "cli/products/compare_scans.h"

#include <fmt/core.h>

#include "cli/console/output_paths.h"
#include "cli/products/export_pictures.h"
#include "rayfield/density/load.h"
#include "rayfield/formats/formats.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWhat = "cannot compare dates";

// A scan by its id, or by its date where the store has one scan of that date.
Result<const tile::ScanEntry*> find_scan(const tile::Snapshot& snapshot, const std::string& wanted) {
  if (const tile::ScanEntry* scan = snapshot.find_scan(wanted)) return scan;
  RAYFIELD_ASSIGN(const auto ids, density::select_scans(snapshot, {wanted}));
  if (ids.size() == 1) return snapshot.find_scan(ids.front());
  std::string names;
  for (const std::string& id : ids) names += (names.empty() ? "" : ", ") + id;
  return fail(ErrorCode::usage, kWhat, wanted, "the store has several scans of that date", "give one of " + names);
}

// One comparison on its way into a folder.
struct Products {
  const tile::Store& store;
  const tile::Snapshot& snapshot;
  const tile::ScanEntry &a, &b;
  const BlockProducts& block;
  const DateComparison& comparison;
  fs::path folder;
  std::vector<fs::path> written = {};

  std::string path(const std::string& ending) {
    written.push_back(folder / fmt::format("{}_{}_{}_{}", block.block, a.scan_id, b.scan_id, ending));
    return written.back().string();
  }
  std::string dates() const { return fmt::format("{} → {}", a.date, b.date); }
};

Result<void> write_scatter(Products& p) {
  formats::PictureOptions options;
  options.title = fmt::format("{}, leaf area of panels", p.block.block);
  options.subtitle = p.dates();
  for (const char* ending : {"scatter.png", "scatter.svg"})
    RAYFIELD_CHECK(formats::write_scatter_chart(p.comparison, p.path(ending), options));
  return {};
}

// The map of date b less that of date a, and for densities its picture.
Result<void> write_change_map(Products& p, const std::string& name) {
  RAYFIELD_ASSIGN(const RasterProduct a, density::load_raster(p.store, p.snapshot, p.a, name));
  RAYFIELD_ASSIGN(const RasterProduct b, density::load_raster(p.store, p.snapshot, p.b, name));
  RAYFIELD_ASSIGN(const RasterProduct change, density::raster_change(a, b));
  formats::GeoTiffOptions tiff;
  tiff.metadata = {{"scan_a", p.a.scan_id}, {"date_a", p.a.date}, {"scan_b", p.b.scan_id}, {"date_b", p.b.date}};
  RAYFIELD_CHECK(formats::write_cog(change, p.block.crs, p.path(change.name + ".tif"), tiff));
  if (name != "plan_density") return {};
  formats::PictureOptions picture;
  picture.title = fmt::format("{}, change of the canopy", p.block.block);
  picture.subtitle = p.dates() + "   " + reference_name(p.block.crs);
  for (const char* ending : {".png", ".svg"})
    RAYFIELD_CHECK(formats::write_plan_picture(change, formats::change_overlay(p.block, p.comparison),
                                               p.path(change.name + ending), picture));
  return {};
}

Result<void> write_products(Products& p, Progress& progress) {
  RAYFIELD_ASSIGN(const OutputFolder made, OutputFolder::make(p.folder));
  progress.stage("compare", 4, "steps");
  RAYFIELD_CHECK(write_scatter(p));
  progress.advance(1);
  for (const char* name : {"plan_density", "canopy_height"}) {
    RAYFIELD_CHECK(write_change_map(p, name));
    progress.advance(1);
  }
  RAYFIELD_CHECK(formats::write_change_geopackage(p.block, p.comparison, p.path("change.gpkg")));
  RAYFIELD_CHECK(formats::write_change_csv(p.comparison, p.path("change.csv")));
  progress.advance(1);
  return {};
}

}  // namespace

Result<ComparisonReport> compare_scans(const tile::Store& store, const ComparisonRequest& request, Progress& progress) {
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  RAYFIELD_ASSIGN(const tile::ScanEntry* a, find_scan(snapshot, request.a));
  RAYFIELD_ASSIGN(const tile::ScanEntry* b, find_scan(snapshot, request.b));
  if (a == b) return fail(ErrorCode::usage, kWhat, a->scan_id, "it is the same scan twice", "give two dates");
  RAYFIELD_ASSIGN(const BlockProducts block, density::load_block(store, snapshot, {a->scan_id, b->scan_id}));
  const std::size_t first = block.scans[0].scan.scan_id == a->scan_id ? 0 : 1;
  ComparisonReport report;
  RAYFIELD_ASSIGN(report.comparison, density::compare_dates(block, first, 1 - first, request.options));
  if (!request.folder) return report;
  Products products{store, snapshot, *a, *b, block, report.comparison, *request.folder};
  RAYFIELD_CHECK(write_products(products, progress));
  report.files = std::move(products.written);
  return report;
}

}  // namespace rayfield::cli
