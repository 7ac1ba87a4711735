#pragma once

#include <vector>

#include "rayfield/tile/snapshot.h"

namespace rayfield::tile {

/// All files that a snapshot names; the pointers live as long as the snapshot.
inline std::vector<const FileEntry*> files_of(const Snapshot& snapshot) {
  std::vector<const FileEntry*> files;
  for (const ScanEntry& scan : snapshot.scans) {
    for (const TileEntry& tile : scan.tiles) {
      files.push_back(&tile.file);
      for (const FileEntry& file : tile.more_files) files.push_back(&file);
    }
    for (const DerivedEntry& derived : scan.derived) files.push_back(&derived.file);
  }
  for (const DerivedEntry& derived : snapshot.registry) files.push_back(&derived.file);
  return files;
}

}  // namespace rayfield::tile
