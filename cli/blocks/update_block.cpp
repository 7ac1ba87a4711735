#include "cli/blocks/update_block.h"

#include <system_error>

#include "cli/console/option_settings.h"
#include "cli/console/output_paths.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/density/registry.h"
#include "rayfield/formats/geopackage.h"

namespace rayfield::cli {
namespace {

Result<tile::Store> open_or_make(const BlockUpdate& block) {
  std::error_code error;
  if (block.crs.empty() || std::filesystem::exists(block.store / "store.json", error))
    return tile::Store::open(block.store);
  RAYFIELD_CHECK(check_outside_stores(block.store, "cannot make a store", "give another folder"));
  RAYFIELD_ASSIGN(const CrsInfo crs, lookup_projected_crs(block.crs));
  RAYFIELD_CHECK(check_crs_scale(crs.code));
  return tile::Store::create(block.store, {.crs = crs.code});
}

// A store that is there already has to be in the CRS that is asked for.
Result<void> check_crs(const tile::Store& store, const BlockUpdate& block) {
  if (block.crs.empty() || same_crs(block.crs, store.config().crs)) return {};
  return fail(ErrorCode::usage, "cannot update the block", block.store.string(),
              "it is in " + store.config().crs + ", not in " + block.crs, "give its own CRS, or leave it out");
}

// Before hours of work: options, and a GeoPackage that may not be replaced after them.
Result<density::ProcessOptions> prepare(const tile::Store& store, const BlockUpdate& block,
                                        const UpdateOptions& options) {
  density::ProcessOptions process;
  RAYFIELD_CHECK(apply_settings(block.settings, process));
  process.threads = options.threads, process.memory_bytes = options.memory_bytes;
  RAYFIELD_CHECK(process.validate());
  if (block.output && !options.overwrite) {
    RAYFIELD_ASSIGN(const tile::Snapshot latest, store.latest());
    RAYFIELD_ASSIGN(const density::BlockNames names, density::read_names(store, latest));
    RAYFIELD_CHECK(formats::check_replaceable({}, {}, (*block.output / (names.block + ".gpkg")).string()));
  }
  return process;
}

}  // namespace

Result<UpdateReport> update_block(const BlockUpdate& block, const UpdateOptions& options, Progress& progress) {
  if (block.output) RAYFIELD_CHECK(check_outside_stores(*block.output, "cannot update the block", "give another -o"));
  RAYFIELD_ASSIGN(tile::Store store, open_or_make(block));
  RAYFIELD_CHECK(check_crs(store, block));
  RAYFIELD_ASSIGN(const density::ProcessOptions process, prepare(store, block, options));
  tile::AddOptions add;
  add.date = block.date, add.name = block.name;
  add.overwrite = options.overwrite;
  add.threads = options.threads, add.memory_bytes = options.memory_bytes;
  add.command = options.command;
  UpdateReport report;
  RAYFIELD_ASSIGN(report.added, add_scan(store, block.inputs, add, progress));
  RAYFIELD_ASSIGN(report.processed, density::process(store, process, options.command, progress));
  if (block.output) {
    ExportOptions products;
    products.keep_unchanged = !options.overwrite;
    products.overwrite = options.overwrite;
    RAYFIELD_ASSIGN(report.exported, export_block(store, *block.output, products, progress));
  }
  RAYFIELD_ASSIGN(const tile::Snapshot latest, store.latest());
  report.snapshot = latest.number;
  return report;
}

}  // namespace rayfield::cli
