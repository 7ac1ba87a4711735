#include "libdensity/pipeline/processed_scan.h"

#include "libdensity/leaf/leaf_products.h"
#include "libdensity/learning/block_registry.h"
#include "libdensity/learning/scan_evidence_stage.h"
#include "libdensity/registry/layout_store.h"
#include "libdensity/scan/scan_echoes.h"
#include "libdensity/scan/stage_versions.h"
#include "rayfield/density/load.h"

namespace rayfield::density {
namespace {

constexpr const char* kKind = "processed";
constexpr int kProcessedVersion = 3;

}  // namespace

Result<std::vector<std::string>> scans_to_process(const tile::Store& store, const tile::Snapshot& snapshot,
                                                  const std::vector<std::string>& dates) {
  if (snapshot.scans.empty())
    return fail(ErrorCode::usage, "nothing to process", store.folder().string(), "the store holds no scan yet",
                "add one with `rayfield add`");
  return select_scans(snapshot, dates);
}

std::string processed_key(const ProcessOptions& options, const tile::ScanEntry& scan, const RowLayout& known,
                          const RowLayout& layout) {
  KeyBuilder key(kKind, kProcessedVersion);
  key.add(stage_versions()).add(option_numbers(options)).add(content_of(scan));
  if (const auto& beam = scan.beam) add_beam(key, *beam);
  if (!has_thin_beam(scan)) key.add(scan.dormant == true ? 1.0 : 0.0);  // measure_echoes()
  add_lines(key, known);
  return key.add(geometry_key(layout)).hex();
}

std::optional<std::string> processed_key(const ProcessOptions& options, const tile::ScanEntry& scan,
                                         BlockRegistry& registry) {
  if (!registry.known() || !registry.has_evidence_of(scan)) return std::nullopt;
  return processed_key(options, scan, registry.known_before(scan), registry.layout_for(scan));
}

const tile::DerivedEntry* find_processed_entry(const tile::ScanEntry& scan) {
  return find_entry(scan.derived, kKind, "block");
}

Result<void> keep_processed(ScanWork& work, const std::string& key, const ProcessedScan& processed) {
  RAYFIELD_CHECK(work.files.get(kKind, "block", key, [&]() -> Result<tile::ArraySet> {
    tile::ArraySet arrays{.kind = kKind, .attributes = "{}"};
    arrays.columns["leaf_size_m2"] = std::vector<double>{processed.leaf_size_m2};
    arrays.columns["voxel_m"] = std::vector<double>{processed.voxel_m};
    arrays.columns["rows_from_one_side"] =
        std::vector<std::int32_t>(processed.rows_from_one_side.begin(), processed.rows_from_one_side.end());
    return arrays;
  }));
  return {};
}

Result<std::optional<ProcessedScan>> find_processed(const ScanWork& work, const std::string& key) {
  const tile::DerivedEntry* entry = find_processed_entry(work.scan);
  if (entry == nullptr || entry->key != key || !work.files.has_all(work.scan.derived)) return std::nullopt;
  RAYFIELD_ASSIGN(const auto totals, read_totals(work.store, work.scan));
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.store.read_derived(*entry));
  RAYFIELD_ASSIGN(const auto leaf_size, arrays.column<double>("leaf_size_m2"));
  RAYFIELD_ASSIGN(const auto voxel, arrays.column<double>("voxel_m"));
  RAYFIELD_ASSIGN(const auto one_sided, arrays.column<std::int32_t>("rows_from_one_side"));
  if (!totals || leaf_size.size() != 1 || voxel.size() != 1) return std::nullopt;
  return ProcessedScan{leaf_size[0], voxel[0], *totals, {one_sided.begin(), one_sided.end()}};
}

}  // namespace rayfield::density
