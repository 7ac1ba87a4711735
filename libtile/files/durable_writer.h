#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <set>
#include <span>
#include <string>

#include "rayfield/core/result.h"
#include "rayfield/tile/snapshot.h"

namespace rayfield::tile {

/// Writes the immutable files of a store. A file appears under its final name complete, flushed to the disk and read
/// back, or not at all; its name becomes durable with sync_directories(), which comes before any snapshot names it.
/// Safe to call from several threads.
class DurableWriter {
 public:
  explicit DurableWriter(std::filesystem::path root) : root_(std::move(root)) {}

  /// Writes `bytes` into `directory` (relative to the store); `file_name` makes the name from the SHA-256 of the bytes.
  /// A file that is already there under that name is replaced: it holds the same bytes or is damaged.
  Result<FileEntry> write(std::span<const std::byte> bytes, const std::string& directory,
                          const std::function<std::string(const std::string& sha256)>& file_name);

  /// Makes the names of all files written so far durable.
  Result<void> sync_directories();
  /// After a failure: removes the files that this writer brought into the store, so that a full disk is not left full.
  /// Only while no snapshot can name them.
  void discard_new_files();
  /// A directory in which an earlier, interrupted run may have left a name that is not durable yet.
  void touch(const std::string& directory);

 private:
  std::filesystem::path root_;
  std::mutex mutex_;
  std::set<std::string> directories_;
  std::set<std::string> new_files_;
};

/// A new file in `directory` with these bytes, flushed and read back, under a temporary name. On failure nothing stays.
Result<std::filesystem::path> write_temporary(const std::filesystem::path& directory, std::span<const std::byte> bytes);

}  // namespace rayfield::tile
