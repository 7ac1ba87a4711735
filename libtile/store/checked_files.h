#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/tile/snapshot.h"

namespace rayfield::tile {

/// The immutable files of a store, checked against the size and SHA-256 that a snapshot gives them before anything is
/// read from them. A file is hashed once while its inode, size and time stay the same: processing opens every tile
/// several times. Thread-safe.
class CheckedFiles {
 public:
  explicit CheckedFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Errors: damaged (another content, missing), resources (no permission).
  Result<void> check(const FileEntry& file) const;
  /// The whole file. Errors: as check().
  Result<std::vector<std::byte>> read(const FileEntry& file) const;

 private:
  struct Seen {
    std::string sha256;
    std::uint64_t inode = 0, size = 0;
    std::int64_t modified_s = 0, modified_ns = 0;
    bool operator==(const Seen&) const = default;
  };
  std::filesystem::path folder_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, Seen> seen_;  // by path
};

/// The error of a file of the store that is not what the snapshot says.
tl::unexpected<Error> file_damaged(const std::filesystem::path& path, const std::string& why);
/// A file that a snapshot names and that is not there is damage, not bad input; lack of permission stays what it is.
Error as_damage(Error error);

}  // namespace rayfield::tile
