#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>

#include "rayfield/core/file.h"
#include "rayfield/core/result.h"

namespace rayfield {

/// Temporary data on disk while a command runs. The file has no name any more, so that its space is freed however the
/// process ends. Thread-safe except for clear(). Errors: resources, with the directory and what to do.
class SpillFile {
 public:
  struct Extent {
    std::uint64_t offset = 0, size = 0;
  };

  /// The file is created with the first append().
  explicit SpillFile(std::filesystem::path directory) : directory_(std::move(directory)) {}
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  Result<Extent> append(std::span<const std::byte> bytes);
  /// Replaces the content of an extent. `bytes` has its size.
  Result<void> overwrite(const Extent& extent, std::span<const std::byte> bytes);
  /// Reads an extent. `bytes` has its size.
  Result<void> read(const Extent& extent, std::span<std::byte> bytes) const;
  /// Reads an extent and frees its space.
  Result<void> take(const Extent& extent, std::span<std::byte> bytes);
  /// Forgets everything and frees the space.
  Result<void> clear();
  std::uint64_t bytes_written() const { return end_.load(); }

 private:
  Result<void> open();

  std::filesystem::path directory_;
  std::mutex mutex_;
  FileDescriptor file_;
  std::atomic<std::uint64_t> end_{0};
};

}  // namespace rayfield
