#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "rayfield/core/file.h"

namespace rayfield::tile {

/// The right to change a store: an exclusive flock(2) on its lock file, held while the object lives and gone with the
/// process. Taking it clears what a writer that died left in tmp/.
class WriterLock {
 public:
  /// Errors: locked (another writer), resources (read-only, no permission), damaged (a link where a folder belongs).
  static Result<WriterLock> take(const std::filesystem::path& store);

 private:
  explicit WriterLock(FileDescriptor file) : file_(std::move(file)) {}
  FileDescriptor file_;
};

/// The number of the newest snapshot that was published, as the lock file notes it: of snapshots that are missing at
/// the end of the history nothing else shows. 0: the store is new. Nothing in stores of earlier versions, or where the
/// note cannot be read.
std::optional<std::uint64_t> last_published(const std::filesystem::path& store);
/// Notes it, after the snapshot has become durable. A note that cannot be written leaves an older one, which says less
/// and nothing wrong.
void note_published(const std::filesystem::path& store, std::uint64_t number);

}  // namespace rayfield::tile
