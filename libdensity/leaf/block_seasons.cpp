#include "libdensity/leaf/block_seasons.h"

#include <algorithm>

#include "libdensity/results/leaf_values.h"
#include "libdensity/season/vine_year.h"

namespace rayfield::density {

Result<BlockSeasons> BlockSeasons::read(const tile::Store& store, const tile::Snapshot& snapshot,
                                        const std::map<std::string, ScanTotals>& processed, bool by_estimate) {
  BlockSeasons seasons;
  seasons.by_estimate_ = by_estimate;
  for (const tile::ScanEntry& scan : snapshot.scans) {
    std::optional<ScanTotals> totals;
    if (const auto now = processed.find(scan.scan_id); now != processed.end()) {
      totals = now->second;
    } else {
      RAYFIELD_ASSIGN(totals, read_totals(store, scan));
    }
    if (!seasons.latitude_deg_) seasons.latitude_deg_ = latitude_of(scan, store.config().crs);
    seasons.entries_.push_back(&scan);
    seasons.scans_.push_back(
        {scan.scan_id, scan.date, scan.dormant, totals ? totals->plant_area_per_m() : std::nullopt});
    seasons.totals_.push_back(totals);
  }
  seasons.verdicts_ = find_dormant_scans(seasons.scans_, seasons.latitude_deg_);
  return seasons;
}

std::optional<std::size_t> BlockSeasons::index_of(const std::string& scan_id) const {
  const auto found = std::find_if(scans_.begin(), scans_.end(), [&](const auto& s) { return s.scan_id == scan_id; });
  if (found == scans_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - scans_.begin());
}

std::optional<WoodScan> BlockSeasons::wood_for(const std::string& scan_id, const VoxelOptions& voxels) const {
  const auto scan = index_of(scan_id);
  if (!scan) return std::nullopt;
  const auto wood = wood_scan_of(*scan, scans_, verdicts_);
  if (!wood) return std::nullopt;
  WoodScan out{*entries_[*wood], voxels};
  if (totals_[*wood] && totals_[*wood]->holds_downward_misses) out.voxels.sure_return_m = 0;
  return out;
}

std::optional<BarestScan> BlockSeasons::barest_for(const std::string& scan_id) const {
  const auto scan = index_of(scan_id);
  if (!scan || wood_scan_of(*scan, scans_, verdicts_)) return std::nullopt;
  const auto barest = barest_scan_of(*scan, scans_, latitude_deg_);
  if (!barest || !totals_[*barest] || totals_[*barest]->thin_plants.empty()) return std::nullopt;
  return BarestScan{scans_[*barest].scan_id, totals_[*barest]->thin_plants};
}

std::string BlockSeasons::verdict_on(const std::string& scan_id) const {
  const auto scan = index_of(scan_id);
  return scan ? verdicts_[*scan].reason : std::string();
}

Result<bool> BlockSeasons::is_outdated(const tile::Store& store, const tile::ScanEntry& scan) const {
  bool processed = false;
  WoodSource used;
  for (const tile::DerivedEntry& entry : scan.derived) {
    processed = processed || entry.kind == "results";
    if (entry.kind != "leaf") continue;
    RAYFIELD_ASSIGN(const tile::ArraySet arrays, store.read_derived(entry));
    RAYFIELD_ASSIGN(used, wood_source_of(arrays));
  }
  const auto wood = wood_for(scan.scan_id, {});
  WoodSource due;
  if (wood)
    due = {wood->scan.scan_id, content_of(wood->scan)};
  else if (by_estimate_)
    due.content = estimate_content(barest_for(scan.scan_id));
  return processed && used != due;
}

}  // namespace rayfield::density
