#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/add_options.h"
#include "rayfield/tile/array_reader.h"
#include "rayfield/tile/arrays.h"
#include "rayfield/tile/derived_writer.h"
#include "rayfield/tile/garbage.h"
#include "rayfield/tile/snapshot.h"
#include "rayfield/tile/store_config.h"
#include "rayfield/tile/tile_reader.h"

namespace rayfield::tile {

/// A problem found by verify(): which file, what is wrong.
struct Damage {
  std::string path, reason;
};

/// What Store::remove() did.
struct RemoveReport {
  std::string scan_id;
  std::uint64_t snapshot = 0;  ///< the newest one now
  bool already_gone = false;   ///< an earlier command has removed the scan: nothing was done
};

/// What Store::revert() did.
struct RevertReport {
  std::uint64_t snapshot = 0;      ///< the newest one now
  bool already_there = false;      ///< the newest snapshot had that content already: nothing was done
  std::vector<std::string> scans;  ///< that the store holds now
};

/// What Store::repair() did, or would do.
struct RepairReport {
  std::uint64_t snapshot = 0;        ///< the newest one now; 0 where nothing was done
  std::vector<Damage> found;         ///< what was wrong with the history; empty: nothing to repair
  std::vector<std::string> rebuilt;  ///< ids of scans that were made again from their files
  std::vector<Damage> left_out;      ///< scans and files of the registry that were not, and why
};

struct OpenStore;

/// The tile store of one block: a folder of immutable files and numbered snapshots (docs/store-format.md).
/// Readers pin a snapshot and never wait. Safe for concurrent readers; one writer at a time (lock, exit code 6).
class Store {
 public:
  static Result<Store> create(const std::filesystem::path& folder, const StoreConfig& config);
  static Result<Store> open(const std::filesystem::path& folder);

  const StoreConfig& config() const;
  const std::filesystem::path& folder() const;
  /// Name of the block: the folder's own name.
  std::string block_name() const;

  /// The newest complete snapshot (number 0 and empty for a new store).
  Result<Snapshot> latest() const;
  Result<std::vector<Snapshot>> history() const;
  /// One snapshot by its number. Errors: usage, when there is none of that number; damaged.
  Result<Snapshot> snapshot(std::uint64_t number) const;

  /// Partitions a stream of rays into tiles and publishes them as a scan. Memory stays below options.memory_bytes.
  Result<AddReport> add(RaySource& rays, const AddOptions& options, Progress& progress);

  /// What add() would return, without reading a ray: a report with already_there if the scan is in the store, nothing
  /// if it may be added. Errors: usage, if another scan has the same id. Worth calling before costly preparations.
  Result<std::optional<AddReport>> find_added(const AddOptions& options) const;

  /// Publishes a snapshot without a scan, named by its id or by a date on which there is one alone. Its files stay:
  /// older snapshots name them, and revert() brings the scan back. Errors: usage (no such scan, several of that date),
  /// locked.
  Result<RemoveReport> remove(const std::string& scan, const std::string& command);
  /// The id of the scan that remove() would remove. Errors: as remove().
  Result<std::string> find_scan_to_remove(const std::string& scan) const;
  /// Publishes a snapshot with the content of an older one. Nothing is deleted, so that this can be reverted too.
  /// Errors: usage (no such snapshot), damaged (files of it are gone; names them), locked.
  Result<RevertReport> revert(std::uint64_t number, const std::string& command);
  /// Records for a scan that the vines bore no leaves, that they did, or (nothing) that it is unknown. Without a change
  /// there is no new snapshot. Errors: usage (no such scan), locked.
  Result<void> set_dormant(const std::string& scan_id, std::optional<bool> dormant, const std::string& command);

  using TileReader = tile::TileReader;
  /// Checks the tile's files. Errors: damaged.
  Result<TileReader> open_tile(const TileEntry& tile) const;

  Result<ArraySet> read_derived(const DerivedEntry& entry) const;
  /// The same file, to be read part by part. Errors: damaged.
  Result<ArrayReader> open_derived(const DerivedEntry& entry) const;
  /// A file kept with a scan. Errors: damaged.
  Result<std::string> read_attachment(const AttachmentEntry& entry) const;

  using DerivedWriter = tile::DerivedWriter;
  /// Takes the writer's lock; ErrorCode::locked when another process holds it.
  Result<DerivedWriter> write_derived();

  /// Checks that no snapshot is missing and that every file of the newest one (with `all`: of all) has its size and
  /// SHA-256.
  Result<std::vector<Damage>> verify(bool all, int threads, Progress& progress) const;
  /// Clears away what no snapshot names and what killed writers have left. Derived and temporary files are deleted;
  /// what cannot be computed again (rays, files kept with a scan, the registry) is moved to trash/. Errors: damaged
  /// (links in the store; missing snapshots, without which it is unknown who needs a file), locked.
  Result<GarbageReport> gc(const GarbageOptions& options);
  /// Repairs a history with missing or unreadable snapshots: publishes the newest intact one, together with the scans
  /// that only the missing ones named, as far as their sealed files describe them. Nothing is deleted.
  /// Errors: locked, resources, interrupted.
  Result<RepairReport> repair(bool dry_run, const std::string& command, Progress& progress);

 private:
  explicit Store(std::shared_ptr<const OpenStore> store) : store_(std::move(store)) {}
  std::shared_ptr<const OpenStore> store_;
};

}  // namespace rayfield::tile
