#include "libtile/store/remove_scan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>

#include "libtile/files/writer_lock.h"
#include "libtile/store/snapshot_log.h"

namespace rayfield::tile {
namespace {

constexpr const char* kWhat = "cannot remove the scan";

std::vector<std::string> scans_of_date(const Snapshot& snapshot, const std::string& date) {
  std::vector<std::string> ids;
  for (const ScanEntry& scan : snapshot.scans)
    if (scan.date == date) ids.push_back(scan.scan_id);
  return ids;
}

// An id that an older snapshot has: the scan was removed, by this command perhaps, which was killed after it had
// published. `date`: ids of that date count too.
Result<std::optional<std::string>> find_removed(const std::vector<Snapshot>& history, const std::string& wanted,
                                                bool date) {
  for (auto snapshot = history.rbegin(); snapshot != history.rend(); ++snapshot) {
    if (snapshot->find_scan(wanted) != nullptr) return wanted;
    const std::vector<std::string> ids = date ? scans_of_date(*snapshot, wanted) : std::vector<std::string>();
    if (!ids.empty()) return ids.front();
  }
  return std::nullopt;
}

struct Target {
  std::string scan_id;
  bool gone = false;
};

// An id wins over a date, also one that was removed before: else a command that is repeated after a kill would go on
// and remove another scan of that date.
Result<Target> find_target(const std::filesystem::path& store, const Snapshot& latest, const std::string& wanted) {
  if (latest.find_scan(wanted) != nullptr) return Target{wanted, false};
  RAYFIELD_ASSIGN(const std::vector<Snapshot> history, all_snapshots(store));
  RAYFIELD_ASSIGN(const auto removed_id, find_removed(history, wanted, false));
  if (removed_id) return Target{*removed_id, true};
  const std::vector<std::string> ids = scans_of_date(latest, wanted);
  if (ids.size() > 1)
    return fail(ErrorCode::usage, kWhat, wanted, fmt::format("there are {} scans of that date", ids.size()),
                fmt::format("name one: {}", fmt::join(ids, ", ")));
  if (ids.size() == 1) return Target{ids.front(), false};
  RAYFIELD_ASSIGN(const auto removed, find_removed(history, wanted, true));
  if (removed) return Target{*removed, true};
  return fail(ErrorCode::usage, kWhat, wanted, "the store has no scan of that date or id", "see `rayfield status`");
}

}  // namespace

Result<std::string> find_scan_to_remove_in(const std::filesystem::path& store, const std::string& scan) {
  RAYFIELD_ASSIGN(const Snapshot latest, latest_snapshot(store));
  RAYFIELD_ASSIGN(Target target, find_target(store, latest, scan));
  return std::move(target.scan_id);
}

// Without working locks another writer may be faster: the scan is then looked for in what that one has published.
Result<RemoveReport> remove_scan(const std::filesystem::path& store, const std::string& scan,
                                 const std::string& command) {
  RAYFIELD_ASSIGN(const WriterLock lock, WriterLock::take(store));
  Target target;
  RAYFIELD_ASSIGN(const Snapshot published,
                  publish(store, command, [&](const Snapshot& latest) -> Result<std::optional<Snapshot>> {
                    RAYFIELD_ASSIGN(target, find_target(store, latest, scan));
                    if (target.gone) return std::nullopt;
                    Snapshot next = latest;
                    std::erase_if(next.scans, [&](const ScanEntry& s) { return s.scan_id == target.scan_id; });
                    return next;
                  }));
  return RemoveReport{target.scan_id, published.number, target.gone};
}

}  // namespace rayfield::tile
