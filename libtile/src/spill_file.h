#pragma once

#include <atomic>
#include <filesystem>
#include <mutex>
#include <span>

#include "file_io.h"

namespace rayfield::tile {

/// Bytes put aside on the disk during one add: a file in the store's tmp/ that has no name any more, so that whatever
/// ends the process also frees the space. Thread-safe; what has been read back is given back to the disk.
class SpillFile {
 public:
  struct Extent {
    std::uint64_t offset = 0, size = 0;
  };

  /// The file is created with the first append().
  explicit SpillFile(std::filesystem::path directory) : directory_(std::move(directory)) {}

  Result<Extent> append(std::span<const std::byte> bytes);
  /// Reads an extent and frees its space. `bytes` has the extent's size.
  Result<void> take(const Extent& extent, std::span<std::byte> bytes);
  std::uint64_t bytes_written() const { return end_.load(); }

 private:
  Result<void> open();

  std::filesystem::path directory_;
  std::mutex mutex_;
  Fd file_;
  std::atomic<std::uint64_t> end_{0};
};

}  // namespace rayfield::tile
