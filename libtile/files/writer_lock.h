#pragma once

#include <filesystem>

#include "rayfield/core/file.h"

namespace rayfield::tile {

/// The right to change a store: an exclusive flock(2) on its lock file, held while the object lives and gone with the
/// process. Taking it clears what a writer that died left in tmp/.
class WriterLock {
 public:
  /// Errors: locked (another writer), resources (read-only, no permission).
  static Result<WriterLock> take(const std::filesystem::path& store);

 private:
  explicit WriterLock(FileDescriptor file) : file_(std::move(file)) {}
  FileDescriptor file_;
};

}  // namespace rayfield::tile
