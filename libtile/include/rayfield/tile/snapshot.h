#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/lidar_beam.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/segments.h"

namespace rayfield::tile {

/// An immutable file of the store.
struct FileEntry {
  std::string path;  ///< relative to the store, '/' separated
  std::uint64_t size = 0;
  std::string sha256;
};

/// One tile of one scan.
struct TileEntry {
  TileIndex index;
  FileEntry file;
  std::vector<FileEntry> more_files;  ///< of a dense tile (over 1 048 576 segments), in the order of the scan
  std::uint64_t segment_count = 0;
  std::uint64_t start_count = 0;  ///< rays that start here
  std::uint64_t hit_count = 0;    ///< hits in the tile proper
  Eigen::AlignedBox3d bounds;     ///< of the segments, m

  /// Names the content of all files of the tile: for keys of what is computed from it.
  std::string content_sha256() const;
};

/// A file computed from others; its key is the hash of everything it depends on.
struct DerivedEntry {
  std::string kind;  ///< "ground", "voxels", "rows" …
  std::string name;  ///< within the kind: a tile "11024_244015" or "block"
  std::string key;   ///< SHA-256 of inputs, parameters and code version
  FileEntry file;
};

/// A file kept with a scan as it was given: the SLAM report, the trajectory.
struct AttachmentEntry {
  std::string name;  ///< "slam.json"; unique in the scan
  FileEntry file;
};

/// Where a scan came from.
struct InputEntry {
  std::string name;  ///< file name, without its folder
  std::uint64_t size = 0;
  std::string sha256;
};

enum class AlignmentVerdict {
  reference,  ///< the first scan: the others are aligned to it
  aligned,    ///< moved onto the block's reference
  unaligned,  ///< left where its own positioning put it, on request
};

/// "reference", "aligned" or "unaligned".
std::string verdict_name(AlignmentVerdict verdict);

/// How a scan was moved onto its block's reference before its rays were put into tiles. NaN = not known.
struct ScanAlignment {
  AlignmentVerdict verdict = AlignmentVerdict::reference;
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< (east, north, height) at the centre of the scan
  Eigen::Vector2d pivot_m = Eigen::Vector2d::Zero();   ///< that centre before the move; the scan is turned about it
  double yaw_rad = 0;                                  ///< from east to north
  double warp_rms_m = 0;                               ///< of the smooth warp at the landmarks; 0 = none
  double residual_m = 0;                               ///< of matched posts and trunks in plan, rms
  double ground_residual_m = 0;                        ///< of the ground's height, median
  double shared_fraction = 0;                          ///< share of posts and trunks seen by both, where both looked
  double margin = 0;                                   ///< log-likelihood over the next best position
  int landmarks = 0;                                   ///< matched posts and trunks
};

struct ScanEntry {
  std::string scan_id;  ///< date, or date_name; unique in the store and usable as a folder name
  std::string date;     ///< YYYY-MM-DD
  std::string name;     ///< the user's own, may be empty
  std::vector<InputEntry> inputs;
  std::uint64_t ray_count = 0, hit_count = 0;
  double start_time_s = 0, end_time_s = 0;   ///< Unix time
  Eigen::AlignedBox3d origin_bounds;         ///< of the ray origins, m
  std::vector<std::string> warnings;         ///< what the reader left out
  std::optional<ScanAlignment> alignment;    ///< absent in stores of earlier versions
  std::optional<bool> dormant;               ///< the user says that the vines bear no leaves, or that they do
  std::optional<LidarBeam> beam;             ///< of the lidar; absent: not known
  std::vector<TileEntry> tiles;              ///< ordered by index
  std::vector<DerivedEntry> derived;         ///< ordered by kind and name
  std::vector<AttachmentEntry> attachments;  ///< ordered by name
};

/// Snapshots with these numbers, both ends included.
struct SnapshotRange {
  std::uint64_t first = 0, last = 0;
  friend bool operator==(const SnapshotRange&, const SnapshotRange&) = default;
};

/// The whole truth at one moment.
struct Snapshot {
  std::uint64_t number = 0, parent = 0;  ///< 0 = none
  std::string created_utc, software_version, command;
  std::vector<ScanEntry> scans;        ///< ordered by date, then scan_id
  std::vector<DerivedEntry> registry;  ///< block-wide: rows, panels, posts and their identities
  std::vector<SnapshotRange> lost;     ///< snapshots known to be gone, ascending: repair() has gone on without them
  const ScanEntry* find_scan(const std::string& scan_id) const;
  /// All files that it names; the pointers live as long as the snapshot.
  std::vector<const FileEntry*> files() const;
};

}  // namespace rayfield::tile
