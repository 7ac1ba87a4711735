#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/tile/snapshot.h"

namespace rayfield::tile {

/// A file to keep with a scan.
struct NewAttachment {
  std::string name;  ///< letters, digits, '.', '_', '-'; "slam.json"
  std::string bytes;
};

/// How a scan is added to a store.
struct AddOptions {
  std::string date;             ///< YYYY-MM-DD
  std::string name;             ///< optional label of the scan
  std::optional<bool> dormant;  ///< see ScanEntry; also changes it for a scan that is already there
  bool overwrite = false;       ///< replace a scan of the same id
  int threads = 0;              ///< 0 = all processors
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< bound on what the partition pass holds
  std::string command;                                  ///< for `rayfield log`
  std::vector<InputEntry> inputs;
  std::optional<ScanAlignment> alignment;  ///< how the rays were moved; kept with the scan
  std::optional<LidarBeam> beam;           ///< of the lidar, where it is known; kept with the scan
  std::vector<NewAttachment> attachments;
};

/// What Store::add() did.
struct AddReport {
  std::string scan_id;
  bool already_there = false;  ///< same id, same inputs: nothing was done
  std::uint64_t ray_count = 0, hit_count = 0, segment_count = 0, bytes_written = 0;
  std::uint64_t dropped = 0;  ///< rays with coordinates that are not finite or out of the CRS's range
  std::size_t tile_count = 0;
  std::vector<std::string> warnings;
};

}  // namespace rayfield::tile
