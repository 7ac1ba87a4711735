#include "cli/blocks/update_needs.h"

#include <system_error>

#include "cli/console/option_settings.h"
#include "cli/console/output_paths.h"
#include "cli/products/export_needs.h"
#include "cli/scans/scan_needs.h"
#include "rayfield/density/plan.h"

namespace rayfield::cli {
namespace {

// Products of the first date of a block: pictures, an empty GeoPackage, maps.
constexpr std::uint64_t kProductsOfAScan = 1'500'000;

// What one more scan adds to the products: as much as the others have on average.
Result<Needs> products_needs(const tile::Store& store, const tile::Snapshot& snapshot, bool one_more) {
  std::size_t exported = 0;
  for (const tile::ScanEntry& scan : snapshot.scans)
    for (const tile::DerivedEntry& entry : scan.derived) exported += entry.kind == "results" ? 1 : 0;
  if (exported == 0) return Needs{kProductsOfAScan, kProductsOfAScan, 0};
  ExportOptions all;
  RAYFIELD_ASSIGN(Needs needs, export_needs(store, all));
  if (one_more) needs.disk_bytes += needs.disk_bytes / exported;
  return needs;
}

}  // namespace

Result<UpdateNeeds> update_needs(const BlockUpdate& block, const UpdateOptions& options, Progress& progress) {
  UpdateNeeds update;
  if (block.output) RAYFIELD_CHECK(check_outside_stores(*block.output, "cannot update the block", "give another -o"));
  density::ProcessOptions process;
  RAYFIELD_CHECK(apply_settings(block.settings, process));
  process.memory_bytes = options.memory_bytes;
  std::error_code error;
  update.makes_store = !block.crs.empty() && !std::filesystem::exists(block.store / "store.json", error);
  if (update.makes_store) {
    RAYFIELD_ASSIGN(const ScanNeeds scan, scan_needs(block.inputs, block.crs, {}, options.memory_bytes, progress));
    update.rays = scan.rays;
    update.needs = scan.needs + Needs{density::expected_bytes({}, scan.rays), 0, 0};
    if (block.output) update.needs = update.needs + Needs{kProductsOfAScan, kProductsOfAScan, 0};
    return update;
  }
  RAYFIELD_ASSIGN(const tile::Store store, tile::Store::open(block.store));
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  tile::AddOptions add;
  add.date = block.date, add.name = block.name, add.overwrite = options.overwrite;
  RAYFIELD_ASSIGN(add.inputs, describe_inputs(block.inputs, options.threads, progress));
  RAYFIELD_ASSIGN(const auto there, store.find_added(add));
  update.already_there = there.has_value();
  update.needs.memory_bytes = options.memory_bytes;
  if (!there) {
    RAYFIELD_ASSIGN(const ScanNeeds scan,
                    scan_needs(block.inputs, store.config().crs, snapshot, options.memory_bytes, progress));
    update.rays = scan.rays;
    update.needs = update.needs + scan.needs + Needs{density::expected_bytes(snapshot, scan.rays), 0, 0};
  }
  if (!snapshot.scans.empty()) {
    RAYFIELD_ASSIGN(const density::ProcessPlan plan, density::plan_process(store, process));
    for (const density::ScanPlan& scan : plan.scans)
      if (scan.is_needed) update.scans.push_back(scan.scan_id);
    update.needs = update.needs + Needs{plan.disk_bytes(), 0, 0};
  }
  if (block.output && (!there || !update.scans.empty())) {
    RAYFIELD_ASSIGN(const Needs products, products_needs(store, snapshot, !there));
    update.needs = update.needs + products;
  }
  return update;
}

}  // namespace rayfield::cli
