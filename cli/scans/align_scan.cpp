#include "cli/scans/align_scan.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "rayfield/core/file.h"
#include "rayfield/density/landmarks.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

// A folder inside the store's tmp/ that is gone afterwards. A lock on it tells gc that it is in use; what a killed
// process leaves is not locked any more, and gc removes it.
class ScratchFolder {
 public:
  static Result<ScratchFolder> create(const fs::path& parent) {
    std::error_code failed;
    fs::create_directories(parent, failed);
    std::string path = (parent / "align.XXXXXX").string();
    if (failed || ::mkdtemp(path.data()) == nullptr)
      return fail_errno(failed ? failed.value() : errno, "cannot make folder", path);
    FileDescriptor held(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    // A gc between mkdtemp() and flock() takes the folder away, and making the scratch store in it says so.
    if (held.valid()) ::flock(held.get(), LOCK_EX);
    return ScratchFolder(path, std::move(held));
  }
  ScratchFolder(ScratchFolder&& other) noexcept
      : path_(std::exchange(other.path_, {})), held_(std::move(other.held_)) {}
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  ScratchFolder(fs::path path, FileDescriptor held) : path_(std::move(path)), held_(std::move(held)) {}
  fs::path path_;
  FileDescriptor held_;
};

Result<BlockLandmarks> landmarks_of(RaySource& rays, const tile::Store& store, const tile::AddOptions& options,
                                    const density::ProcessOptions& process, Progress& progress) {
  RAYFIELD_ASSIGN(const ScratchFolder scratch, ScratchFolder::create(store.folder() / "tmp"));
  RAYFIELD_ASSIGN(tile::Store tiles, tile::Store::create(scratch.path() / "tiles", store.config()));
  RAYFIELD_ASSIGN(const tile::AddReport added, tiles.add(rays, options, progress));
  return density::find_landmarks(tiles, added.scan_id, process, progress);
}

tile::ScanAlignment record_of(const align::Alignment& alignment) {
  tile::ScanAlignment record;
  record.verdict = tile::AlignmentVerdict::aligned;
  record.offset_m = alignment.shift.shift;
  record.pivot_m = alignment.shift.pivot;
  record.yaw_rad = alignment.shift.yaw_rad;
  record.warp_rms_m = alignment.warp_rms_m;
  record.residual_m = alignment.residual_rms_m;
  record.ground_residual_m = alignment.ground_residual_m;
  record.shared_fraction = alignment.shared_fraction;
  record.margin = alignment.margin;
  record.landmarks = alignment.landmarks;
  return record;
}

// The only scan of a store that keeps no layout yet may be replaced by anything: it takes its place as the reference.
bool replaces_the_reference(const tile::Snapshot& snapshot, const tile::AddOptions& options) {
  return options.overwrite && snapshot.registry.empty() && snapshot.scans.size() == 1 &&
         snapshot.scans.front().date == options.date && snapshot.scans.front().name == options.name;
}

}  // namespace

Result<ScanPlacement> place_scan(tile::Store& store, RaySource& rays, const align::AlignOptions& align_options,
                                 const tile::AddOptions& options, Progress& progress) {
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  if (replaces_the_reference(snapshot, options)) return ScanPlacement{};
  density::ProcessOptions process;
  process.threads = options.threads, process.memory_bytes = options.memory_bytes;
  RAYFIELD_ASSIGN(const auto reference, density::reference_landmarks(store, process, options.command, progress));
  if (!reference) return ScanPlacement{};
  auto landmarks = landmarks_of(rays, store, options, process, progress);
  if (!landmarks) {
    if (landmarks.error().code == ErrorCode::bad_input)
      landmarks.error().why += "; scans of a block are laid on each other by rows, posts and trunks";
    return tl::make_unexpected(std::move(landmarks).error());
  }
  RAYFIELD_ASSIGN(const bool rewound, rays.rewind());
  if (!rewound)
    return fail(ErrorCode::usage, "cannot align the scan", rays.name(), "it cannot be read twice",
                "give a file, or --no-align");
  ScanPlacement placement;
  RAYFIELD_ASSIGN(placement.alignment, align::align_landmarks(*reference, *landmarks, align_options, rays.name()));
  placement.record = record_of(*placement.alignment);
  return placement;
}

std::string alignment_file(const ScanPlacement& placement) {
  const tile::ScanAlignment& record = placement.record;
  nlohmann::ordered_json json = {{"verdict", tile::verdict_name(record.verdict)},
                                 {"pivot_m", {record.pivot_m.x(), record.pivot_m.y()}},
                                 {"offset_m", {record.offset_m.x(), record.offset_m.y(), record.offset_m.z()}},
                                 {"yaw_rad", record.yaw_rad}};
  if (!placement.alignment) return json.dump(1) + "\n";
  const align::Alignment& alignment = *placement.alignment;
  json["landmarks"] = alignment.landmarks;
  json["residual_m"] = alignment.residual_rms_m;
  json["rivals"] = nlohmann::ordered_json::array();
  for (const align::Rival& rival : alignment.rivals)
    json["rivals"].push_back({{"along_rows_m", rival.along_rows_m},
                              {"across_rows_m", rival.across_rows_m},
                              {"turn_rad", rival.turn_rad},
                              {"log_ratio", rival.log_ratio}});
  const align::Warp& warp = alignment.warp;
  if (warp.empty()) return json.dump(1) + "\n";
  nlohmann::ordered_json control = nlohmann::ordered_json::array();
  for (const Eigen::Vector3d& c : warp.control) control.push_back({c.x(), c.y(), c.z()});
  json["warp"] = {{"origin_m", {warp.origin.x(), warp.origin.y()}},
                  {"spacing_m", warp.spacing_m},
                  {"nx", warp.nx},
                  {"ny", warp.ny},
                  {"control_m", std::move(control)}};
  return json.dump(1) + "\n";
}

}  // namespace rayfield::cli
