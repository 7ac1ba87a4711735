#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "rayfield/tile/store.h"

namespace rayfield::tile {

struct Store::Impl {
  std::filesystem::path folder;
  StoreConfig config;

  /// Checks a file of the store against its entry. A file is hashed once while its inode, size and time stay the same:
  /// processing opens every tile several times. Errors: damaged.
  Result<void> check_file(const FileEntry& file) const;

 private:
  struct Checked {
    std::string sha256;
    std::uint64_t inode = 0, size = 0;
    std::int64_t modified_s = 0, modified_ns = 0;
    bool operator==(const Checked&) const = default;
  };
  mutable std::mutex mutex_;
  mutable std::map<std::string, Checked> checked_;
};

}  // namespace rayfield::tile
