#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"
#include "rayfield/tile/snapshot.h"

namespace rayfield::tile {

struct OpenStore;

/// A derived file to publish: arrays under a kind, name and key.
struct NewDerived {
  std::string scan_id;  ///< empty = block-wide (registry)
  std::string kind, name, key;
};

/// Writes derived files durably and publishes them in one new snapshot at commit(). Files with a key that is already
/// published are kept. put() is safe to call from several threads. Without commit() nothing changes, but files that
/// were already written are found again by their key, so that interrupted work resumes.
/// Made by Store::write_derived(); holds the writer's lock of the store while it lives.
class DerivedWriter {
 public:
  /// A file of that kind, name and key written earlier (published or not), if it is there and intact.
  std::optional<DerivedEntry> find(const NewDerived& what) const;
  Result<DerivedEntry> put(const NewDerived& what, const ArraySet& arrays);
  /// The same for columns that are too large to be in memory: their compressed form is.
  Result<DerivedEntry> put(const NewDerived& what, const StreamedArrays& arrays);
  /// Where temporary files may be made during the work (SpillFile).
  std::filesystem::path scratch_folder() const;
  /// `keep`: the complete set of derived entries that the scan (or, for "", the registry) shall have from now on.
  Result<void> set(const std::string& scan_id, std::vector<DerivedEntry> keep);
  Result<Snapshot> commit(const std::string& command);

 private:
  friend class Store;
  /// Takes the lock. Errors: locked.
  static Result<DerivedWriter> open(std::shared_ptr<const OpenStore> store);
  Result<DerivedEntry> put_columns(const NewDerived& what, const ArraySet& arrays,
                                   const std::map<std::string, ColumnSource>& streamed);

  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace rayfield::tile
