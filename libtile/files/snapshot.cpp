#include "rayfield/tile/snapshot.h"

#include "rayfield/core/sha256.h"

namespace rayfield::tile {

std::string TileEntry::content_sha256() const {
  if (more_files.empty()) return file.sha256;
  std::string all = file.sha256;
  for (const FileEntry& f : more_files) all += f.sha256;
  return sha256_hex(all);
}

const ScanEntry* Snapshot::find_scan(const std::string& scan_id) const {
  for (const ScanEntry& scan : scans) {
    if (scan.scan_id == scan_id) return &scan;
  }
  return nullptr;
}

std::vector<const FileEntry*> Snapshot::files() const {
  std::vector<const FileEntry*> files;
  for (const ScanEntry& scan : scans) {
    for (const TileEntry& tile : scan.tiles) {
      files.push_back(&tile.file);
      for (const FileEntry& file : tile.more_files) files.push_back(&file);
    }
    for (const DerivedEntry& derived : scan.derived) files.push_back(&derived.file);
    for (const AttachmentEntry& attachment : scan.attachments) files.push_back(&attachment.file);
  }
  for (const DerivedEntry& derived : registry) files.push_back(&derived.file);
  return files;
}

}  // namespace rayfield::tile
