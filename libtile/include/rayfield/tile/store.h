#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/progress.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"
#include "rayfield/tile/segments.h"
#include "rayfield/tile/snapshot.h"
#include "rayfield/tile/store_config.h"

namespace rayfield::tile {

struct AddOptions {
  std::string date;                                     ///< YYYY-MM-DD
  std::string name;                                     ///< optional label of the scan
  bool overwrite = false;                               ///< replace a scan of the same id
  int threads = 0;                                      ///< 0 = all processors
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< bound on what the partition pass holds
  std::string command;                                  ///< for `rayfield log`
  std::vector<InputEntry> inputs;
};

struct AddReport {
  std::string scan_id;
  bool already_there = false;  ///< same id, same inputs: nothing was done
  std::uint64_t ray_count = 0, hit_count = 0, segment_count = 0, bytes_written = 0;
  std::uint64_t dropped = 0;  ///< rays with coordinates that are not finite or out of the CRS's range
  std::size_t tile_count = 0;
  std::vector<std::string> warnings;
};

/// A problem found by verify(): which file, what is wrong.
struct Damage {
  std::string path, reason;
};

/// A derived file to publish: arrays under a kind, name and key.
struct NewDerived {
  std::string scan_id;  ///< empty = block-wide (registry)
  std::string kind, name, key;
};

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

  /// Partitions a stream of rays into tiles and publishes them as a scan. Memory stays below options.memory_bytes.
  Result<AddReport> add(RaySource& rays, const AddOptions& options, Progress& progress);

  /// What add() would answer without reading a ray: a report with already_there when the scan is in the store, nothing
  /// when it may be added. Errors: usage, when another scan has the same id. Worth asking before costly preparations.
  Result<std::optional<AddReport>> find_added(const AddOptions& options) const;

  /// Streams a tile's segments in chunks, each decoded on its own: chunk_count() and read_chunk(i) may be called from
  /// several threads at once. Chunks hold at most 131072 segments.
  class TileReader {
   public:
    std::size_t chunk_count() const;
    std::size_t chunk_size(std::size_t chunk) const;  ///< segments in that chunk
    Result<void> read_chunk(std::size_t chunk, SegmentBatch& segments) const;

   private:
    friend class Store;
    struct Impl;
    std::shared_ptr<const Impl> impl_;
  };
  Result<TileReader> open_tile(const TileEntry& tile) const;

  Result<ArraySet> read_derived(const DerivedEntry& entry) const;

  /// Writes derived files durably and publishes them in one new snapshot at commit(). Files with a key that is already
  /// published are kept. put() is safe to call from several threads. Dropped without commit(): nothing changes, but
  /// files already written are found again by their key, so that work that was interrupted resumes.
  class DerivedWriter {
   public:
    /// A file of that kind, name and key written earlier (published or not), if it is there and intact.
    std::optional<DerivedEntry> find(const NewDerived& what) const;
    Result<DerivedEntry> put(const NewDerived& what, const ArraySet& arrays);
    /// `keep`: the complete set of derived entries that the scan (or, for "", the registry) shall have from now on.
    Result<void> set(const std::string& scan_id, std::vector<DerivedEntry> keep);
    Result<Snapshot> commit(const std::string& command);

   private:
    friend class Store;
    struct Impl;
    std::shared_ptr<Impl> impl_;
  };
  /// Takes the writer's lock; ErrorCode::locked when another process holds it.
  Result<DerivedWriter> write_derived();

  /// Checks every file of the newest snapshot (all snapshots with `all`) against its size and SHA-256.
  Result<std::vector<Damage>> verify(bool all, int threads, Progress& progress) const;
  /// Removes files that no snapshot names and left-over temporary files; returns the bytes freed.
  Result<std::uint64_t> gc(bool dry_run);

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace rayfield::tile
