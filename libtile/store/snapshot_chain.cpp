#include "libtile/store/snapshot_chain.h"

#include <fmt/format.h>

#include <algorithm>

#include "libtile/files/file_io.h"
#include "libtile/files/store_folder.h"
#include "libtile/files/store_layout.h"
#include "libtile/files/writer_lock.h"
#include "libtile/store/snapshot_log.h"

namespace rayfield::tile {
namespace {

std::string file_of(std::uint64_t number) {
  return std::string(layout::kSnapshots) + "/" + layout::snapshot_file_name(number);
}

bool is_lost(const std::vector<SnapshotRange>& lost, std::uint64_t number) {
  return std::any_of(lost.begin(), lost.end(),
                     [number](const SnapshotRange& r) { return r.first <= number && number <= r.last; });
}

// The ranges of [first, last] that `lost` does not cover.
std::vector<SnapshotRange> uncovered(std::uint64_t first, std::uint64_t last, const std::vector<SnapshotRange>& lost) {
  std::vector<SnapshotRange> gaps;
  for (const SnapshotRange& range : lost) {
    if (range.last < first || range.first > last) continue;
    if (range.first > first) gaps.push_back({first, range.first - 1});
    first = range.last + 1;
  }
  if (first <= last) gaps.push_back({first, last});
  return gaps;
}

void find_missing(SnapshotChain& chain, const std::vector<std::uint64_t>& numbers) {
  const std::vector<SnapshotRange> lost =
      chain.intact.empty() ? std::vector<SnapshotRange>() : chain.intact.rbegin()->second.lost;
  std::uint64_t expected = 1;
  const auto gap_until = [&](std::uint64_t end) {
    if (expected >= end) return;
    for (const SnapshotRange& gap : uncovered(expected, end - 1, lost)) chain.missing.push_back(gap);
  };
  for (const std::uint64_t number : numbers) {
    gap_until(number);
    expected = number + 1;
  }
  gap_until(chain.published.value_or(0) + 1);
  for (const SnapshotRange& gap : chain.missing)
    chain.damage.push_back(
        {file_of(gap.first), gap.first == gap.last
                                 ? std::string("the snapshot is missing")
                                 : fmt::format("the snapshots {} to {} are missing", gap.first, gap.last)});
}

// Between a snapshot and its parent lie only those that are lost, or missing and reported as such.
void check_parents(SnapshotChain& chain) {
  for (const auto& [number, snapshot] : chain.intact) {
    const std::uint64_t before = number - 1;
    if (snapshot.parent == before) continue;
    const bool over_lost = snapshot.parent < before && is_lost(snapshot.lost, before) &&
                           uncovered(snapshot.parent + 1, before, snapshot.lost).empty();
    if (!over_lost)
      chain.damage.push_back(
          {file_of(number), fmt::format("it was made from snapshot {}, not from {}: it is of another "
                                        "history",
                                        snapshot.parent, before)});
  }
}

// A store that does not know what it published, as in earlier versions: scans without any snapshot show it.
Result<bool> has_scans(const std::filesystem::path& store) {
  RAYFIELD_ASSIGN(const FileDescriptor folder, open_store_folder(store));
  RAYFIELD_ASSIGN(const FileDescriptor scans, open_folder_in(folder, layout::kScans, store / layout::kScans));
  if (!scans.valid()) return false;
  RAYFIELD_ASSIGN(const auto entries, list_folder(scans, store / layout::kScans));
  return !entries.empty();
}

}  // namespace

std::uint64_t SnapshotChain::highest() const {
  std::uint64_t highest = published.value_or(0);
  if (!intact.empty()) highest = std::max(highest, intact.rbegin()->first);
  if (!unreadable.empty()) highest = std::max(highest, unreadable.rbegin()->first);
  return highest;
}

bool SnapshotChain::lost_the_newest() const { return intact.empty() ? !whole() : highest() > intact.rbegin()->first; }

Result<SnapshotChain> read_chain(const std::filesystem::path& store) {
  SnapshotChain chain;
  chain.published = last_published(store);  // before the names: see latest_snapshot()
  RAYFIELD_ASSIGN(const std::vector<std::uint64_t> numbers, snapshot_numbers(store));
  for (const std::uint64_t number : numbers) {
    auto snapshot = load_snapshot(store, number);
    if (snapshot) {
      chain.intact.emplace(number, std::move(*snapshot));
    } else if (snapshot.error().code == ErrorCode::resources) {
      return tl::make_unexpected(std::move(snapshot).error());
    } else {
      chain.damage.push_back({file_of(number), snapshot.error().why});
      chain.unreadable.emplace(number, std::move(snapshot).error());
    }
  }
  find_missing(chain, numbers);
  check_parents(chain);
  if (numbers.empty() && !chain.published) {
    RAYFIELD_ASSIGN(const bool scans, has_scans(store));
    if (scans) chain.damage.push_back({layout::kSnapshots, "no snapshot is there, though there are files of scans"});
  }
  return chain;
}

}  // namespace rayfield::tile
