#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::tile {

/// The history of a store as it is there. Every snapshot was made from the one before it, so that the numbers up to the
/// newest that was published (writer_lock.h) are all there, but for those that a repair has recorded as lost.
struct SnapshotChain {
  std::optional<std::uint64_t> published;    ///< the newest that there was, where the store knows it
  std::map<std::uint64_t, Snapshot> intact;  ///< by number
  std::map<std::uint64_t, Error> unreadable;
  std::vector<SnapshotRange> missing;  ///< without those recorded as lost; ascending
  std::vector<Damage> damage;          ///< all that is wrong, for verify

  bool whole() const { return damage.empty(); }
  /// The highest number that is known to have been given.
  std::uint64_t highest() const;
  /// Snapshots behind the newest intact one are gone, or all there were.
  bool lost_the_newest() const;
};

/// Errors: damaged (the folder of the snapshots cannot be read).
Result<SnapshotChain> read_chain(const std::filesystem::path& store);

}  // namespace rayfield::tile
