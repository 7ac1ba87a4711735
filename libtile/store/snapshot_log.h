#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/tile/snapshot.h"

/// The numbered snapshots of a store.
namespace rayfield::tile {

/// Numbers of the snapshots that are there, ascending.
Result<std::vector<std::uint64_t>> snapshot_numbers(const std::filesystem::path& store);
std::filesystem::path snapshot_path(const std::filesystem::path& store, std::uint64_t number);
Result<Snapshot> load_snapshot(const std::filesystem::path& store, std::uint64_t number);
/// The same for a number that a user gave. Errors: usage, with the numbers that there are.
Result<Snapshot> existing_snapshot(const std::filesystem::path& store, std::uint64_t number);
Result<std::vector<Snapshot>> all_snapshots(const std::filesystem::path& store);
/// Number 0 and empty where there is none yet. Errors: damaged, where a newer one than is there has been published.
Result<Snapshot> latest_snapshot(const std::filesystem::path& store);

/// Publishes what `change` makes of the newest snapshot as the next one, by exclusive link(). Where another writer was
/// faster, `change` is asked again on the other's snapshot. `change` may answer nothing: the newest snapshot then
/// stands, and is made durable. All files that the new snapshot names must be durable before.
Result<Snapshot> publish(const std::filesystem::path& store, const std::string& command,
                         const std::function<Result<std::optional<Snapshot>>(const Snapshot& latest)>& change);

/// Publishes `next`, which has its number and its parent, unless another writer takes the number first (false).
Result<bool> publish_as(const std::filesystem::path& store, const std::string& command, Snapshot& next);

}  // namespace rayfield::tile
