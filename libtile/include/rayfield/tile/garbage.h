#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rayfield::tile {

struct GarbageOptions {
  bool dry_run = false;
  bool empty_trash = false;  ///< also delete what earlier runs moved to trash/
};

/// A file that no snapshot names.
struct GarbageFile {
  std::string path;  ///< relative to the store
  std::uint64_t size = 0;
  bool to_trash = false;  ///< moved to trash/: it cannot be computed again
};

/// What Store::gc() did, or would do.
struct GarbageReport {
  std::uint64_t bytes_removed = 0;   ///< of temporary and derived files, and of the trash
  std::uint64_t bytes_moved = 0;     ///< to trash/
  std::vector<GarbageFile> files;    ///< in scans/ and registry/
  std::vector<std::string> foreign;  ///< not named like a file of the store: left where they are
};

}  // namespace rayfield::tile
