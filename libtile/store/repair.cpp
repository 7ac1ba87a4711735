#include "libtile/store/repair.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <set>
#include <tuple>

#include "libtile/files/fault.h"
#include "libtile/files/file_io.h"
#include "libtile/files/store_folder.h"
#include "libtile/files/store_layout.h"
#include "libtile/files/writer_lock.h"
#include "libtile/store/rebuilt_scan.h"
#include "libtile/store/snapshot_chain.h"
#include "libtile/store/snapshot_log.h"

namespace rayfield::tile {
namespace {

namespace fs = std::filesystem;

// Numbers that are gone, those of snapshots that cannot be read among them; neighbours in one range.
std::vector<SnapshotRange> lost_of(const SnapshotChain& chain, const std::vector<SnapshotRange>& known) {
  std::vector<SnapshotRange> all = known;
  all.insert(all.end(), chain.missing.begin(), chain.missing.end());
  for (const auto& [number, error] : chain.unreadable) all.push_back({number, number});
  std::sort(all.begin(), all.end(), [](const SnapshotRange& a, const SnapshotRange& b) { return a.first < b.first; });
  std::vector<SnapshotRange> merged;
  for (const SnapshotRange& range : all) {
    if (!merged.empty() && range.first <= merged.back().last + 1)
      merged.back().last = std::max(merged.back().last, range.last);
    else
      merged.push_back(range);
  }
  return merged;
}

// Scans of which files lie in the store that no snapshot names.
Result<void> rebuild_scans(const Store& store, const SnapshotChain& chain, Snapshot& next, RepairReport& report,
                           Progress& progress) {
  std::set<std::string> named;
  for (const auto& [number, snapshot] : chain.intact)
    for (const FileEntry* file : snapshot.files()) named.insert(file->path);
  RAYFIELD_ASSIGN(const FileDescriptor top, open_store_folder(store.folder()));
  RAYFIELD_ASSIGN(const FileDescriptor scans, open_folder_in(top, layout::kScans, store.folder() / layout::kScans));
  if (!scans.valid()) return {};
  RAYFIELD_ASSIGN(const auto folders, list_folder(scans, store.folder() / layout::kScans));
  progress.stage("rebuilding scans", folders.size(), "scans");
  for (const FolderEntry& folder : folders) {
    progress.advance(1);
    const bool known = next.find_scan(folder.name) != nullptr;
    if (folder.kind != FolderEntry::Kind::folder || !layout::is_plain_name(folder.name) || known) continue;
    auto scan = rebuild_scan(store, folder.name, named, progress);
    if (scan) {
      report.rebuilt.push_back(folder.name);
      next.scans.push_back(std::move(*scan));
    } else if (scan.error().code == ErrorCode::damaged || scan.error().code == ErrorCode::bad_input) {
      report.left_out.push_back({std::string(layout::kScans) + "/" + folder.name, scan.error().why});
    } else {
      return tl::make_unexpected(std::move(scan).error());
    }
  }
  std::sort(next.scans.begin(), next.scans.end(), [](const ScanEntry& a, const ScanEntry& b) {
    return std::tie(a.date, a.scan_id) < std::tie(b.date, b.scan_id);
  });
  return {};
}

// Snapshots that cannot be read make way, so that what is left is whole.
Result<void> put_aside_unreadable(const fs::path& store, const SnapshotChain& chain) {
  const fs::path place = fs::path(layout::kTrash) / layout::kSnapshots;
  if (!chain.unreadable.empty()) RAYFIELD_CHECK(make_directories(store, place));
  for (const auto& [number, error] : chain.unreadable) {
    const fs::path from = snapshot_path(store, number);
    if (const int fault = fault::point("rename")) return fail_io(fault, "cannot move to the trash", from);
    if (std::rename(from.c_str(), (store / place / from.filename()).c_str()) != 0)
      return fail_io(errno, "cannot move to the trash", from);
  }
  return {};
}

}  // namespace

Result<RepairReport> repair_store(const Store& store, bool dry_run, const std::string& command, Progress& progress) {
  std::optional<WriterLock> lock;
  if (!dry_run) {
    RAYFIELD_ASSIGN(lock, WriterLock::take(store.folder()));
  }
  RAYFIELD_ASSIGN(const SnapshotChain chain, read_chain(store.folder()));
  RepairReport report;
  report.found = chain.damage;
  // A history that another was mixed into is for somebody to look at: nothing says which of the two is right.
  const bool gone = !chain.missing.empty() || !chain.unreadable.empty() || chain.intact.empty();
  if (chain.whole() || !gone) return report;
  Snapshot next = chain.intact.empty() ? Snapshot{} : chain.intact.rbegin()->second;
  next.parent = next.number;
  next.number = chain.highest() + 1;
  next.lost = lost_of(chain, next.lost);
  if (chain.lost_the_newest()) RAYFIELD_CHECK(rebuild_scans(store, chain, next, report, progress));
  if (chain.intact.empty()) {
    std::vector<std::string> left_out;
    RAYFIELD_ASSIGN(next.registry, rebuild_registry(store, left_out));
    for (const std::string& name : left_out)
      report.left_out.push_back({std::string(layout::kRegistry) + "/" + name, "it is there in several versions"});
  }
  report.snapshot = next.number;
  if (dry_run) return report;
  RAYFIELD_ASSIGN(const bool published, publish_as(store.folder(), command, next));
  if (!published)
    return fail(ErrorCode::locked, "cannot publish", store.folder().string(), "another writer has published",
                "run the same command again");
  RAYFIELD_CHECK(put_aside_unreadable(store.folder(), chain));
  return report;
}

}  // namespace rayfield::tile
