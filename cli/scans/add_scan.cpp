#include "cli/scans/add_scan.h"

#include <fmt/core.h>

#include <memory>

#include "cli/drives/drive_files.h"
#include "cli/drives/drive_log.h"
#include "cli/scans/align_scan.h"
#include "cli/scans/open_cloud.h"
#include "cli/scans/scan_date.h"
#include "cli/scans/scan_place.h"
#include "rayfield/core/file.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/core/parallel.h"
#include "rayfield/density/missing_rays.h"
#include "rayfield/formats/formats.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

// Several streams one after the other.
class JoinedSource : public RaySource {
 public:
  JoinedSource(std::vector<std::unique_ptr<RaySource>> parts, std::vector<std::string> warnings)
      : parts_(std::move(parts)), warnings_(std::move(warnings)) {}

  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override {
    for (; current_ < parts_.size(); ++current_) {
      RAYFIELD_ASSIGN(const std::size_t count, parts_[current_]->read(batch, max_rays));
      if (count > 0) return count;
    }
    batch.clear();
    return std::size_t{0};
  }

  Result<bool> rewind() override {
    for (const auto& part : parts_) {
      RAYFIELD_ASSIGN(const bool rewound, part->rewind());
      if (!rewound) return false;
    }
    current_ = 0;
    return true;
  }

  std::optional<std::uint64_t> ray_count() const override {
    std::uint64_t total = 0;
    for (const auto& part : parts_) {
      const auto count = part->ray_count();
      if (!count) return std::nullopt;
      total += *count;
    }
    return total;
  }

  std::string name() const override {
    return parts_.size() == 1 ? parts_[0]->name() : fmt::format("{} and {} more", parts_[0]->name(), parts_.size() - 1);
  }

  std::vector<std::string> warnings() const override {
    std::vector<std::string> all = warnings_;
    for (const auto& part : parts_)
      for (const std::string& warning : part->warnings()) all.push_back(warning);
    return all;
  }

 private:
  std::vector<std::unique_ptr<RaySource>> parts_;
  std::vector<std::string> warnings_;  // of the logs behind them
  std::size_t current_ = 0;
};

// Size and SHA-256 of a file.
Result<tile::InputEntry> describe_input(const fs::path& path, const Progress& progress) {
  RAYFIELD_ASSIGN(FileDigest digest,
                  digest_file(path.string(), "cannot read input", [&progress] { return progress.cancelled(); }));
  return tile::InputEntry{path.filename().string(), digest.size, std::move(digest.sha256)};
}

// What an input says about the lidar's beam, where the rig file does not.
void add_knowledge(const std::optional<LidarBeam>& told, std::optional<LidarBeam>& beam) {
  if (!beam) beam = told;
  if (!told || !told->same_disc(*beam)) return;
  if (!beam->range_resolution_m) beam->range_resolution_m = told->range_resolution_m;
  if (!beam->returns) beam->returns = told->returns;
}

// A log as a stream of rays: it goes through SLAM.
Result<std::unique_ptr<RaySource>> open_log_rays(const fs::path& path, const ScanInputs& inputs, const std::string& crs,
                                                 const fs::path& scratch, int threads, Progress& progress,
                                                 std::vector<std::string>& warnings,
                                                 std::vector<tile::NewAttachment>& attachments,
                                                 std::optional<LidarBeam>& beam) {
  RAYFIELD_CHECK(require_rig(path, inputs));
  slam::SlamOptions options;
  options.threads = threads;
  options.scratch = scratch.string();
  RAYFIELD_ASSIGN(RegisteredDrive drive, register_drive(path.string(), inputs.rig_file, crs, true, options, progress));
  for (const std::string& warning : drive.report.warnings) progress.warn(warning);
  for (const std::string& warning : all_warnings(drive)) warnings.push_back(path.filename().string() + ": " + warning);
  RAYFIELD_CHECK(keep_drive_files(drive, attachments));
  add_knowledge(drive.beam, beam);
  return std::move(drive.rays);
}

// The same rays twice count twice.
Result<void> check_given_once(const std::vector<fs::path>& files, const std::vector<tile::InputEntry>& entries) {
  for (std::size_t i = 0; i < files.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (entries[i].sha256 == entries[j].sha256)
        return fail(ErrorCode::usage, "cannot add scan", files[i].string(),
                    files[i] == files[j] ? "it is given twice" : "it has the same content as " + files[j].string(),
                    "give each file once");
  return {};
}

// Of an input that a scan of another day or name has, too: one of the two dates may be wrong.
std::optional<std::string> said_of_repeated(const std::vector<tile::InputEntry>& inputs, std::size_t rays,
                                            const tile::Snapshot& latest, const std::string& replaced) {
  for (std::size_t i = 0; i < rays; ++i)
    for (const tile::ScanEntry& scan : latest.scans)
      for (const tile::InputEntry& other : scan.inputs)
        if (scan.scan_id != replaced && other.sha256 == inputs[i].sha256)
          return fmt::format("{} was added as {} before: one of them has a wrong date, or is there twice",
                             inputs[i].name, scan.scan_id);
  return std::nullopt;
}

// The id of the scan that this one takes the place of; empty where there is none.
std::string id_of_same_name(const tile::Snapshot& snapshot, const tile::AddOptions& options) {
  for (const tile::ScanEntry& scan : snapshot.scans)
    if (scan.date == options.date && scan.name == options.name) return scan.scan_id;
  return {};
}

// A scan that shall not be aligned is the reference all the same where it is the first.
Result<ScanPlacement> place(tile::Store& store, RaySource& rays, const ScanInputs& inputs,
                            const tile::AddOptions& options, Progress& progress) {
  if (inputs.align) return place_scan(store, rays, inputs.align_options, options, progress);
  RAYFIELD_ASSIGN(const tile::Snapshot snapshot, store.latest());
  ScanPlacement placement;
  if (!snapshot.scans.empty()) placement.record.verdict = tile::AlignmentVerdict::unaligned;
  return placement;
}

}  // namespace

Result<void> require_rig(const fs::path& log, const ScanInputs& inputs) {
  if (!inputs.rig_file.empty()) return {};
  return fail(ErrorCode::usage, "cannot add log", log.string(), "a log needs a rig file",
              "give --rig RIG.toml; `rayfield info` proposes one");
}

Result<std::vector<tile::InputEntry>> describe_inputs(const ScanInputs& inputs, int threads, const Progress& progress) {
  RAYFIELD_CHECK(check_trajectory_given(inputs));
  std::vector<fs::path> files = inputs.files;
  if (!inputs.rig_file.empty()) files.emplace_back(inputs.rig_file);
  if (!inputs.trajectory_file.empty()) files.emplace_back(inputs.trajectory_file);
  std::vector<tile::InputEntry> entries(files.size());
  RAYFIELD_CHECK(parallel_for(files.size(), threads, [&](std::size_t i, int) -> Result<void> {
    RAYFIELD_ASSIGN(entries[i], describe_input(files[i], progress));
    return {};
  }));
  RAYFIELD_CHECK(check_given_once(inputs.files, entries));
  return entries;
}

Result<AddedScan> add_scan(tile::Store& store, const ScanInputs& inputs, tile::AddOptions options, Progress& progress) {
  RAYFIELD_ASSIGN(options.inputs, describe_inputs(inputs, options.threads, progress));
  RAYFIELD_ASSIGN(auto there, store.find_added(options));
  if (there) {
    if (options.dormant) RAYFIELD_CHECK(store.set_dormant(there->scan_id, options.dormant, options.command));
    return AddedScan{std::move(*there), {}, {}, {}};
  }
  // A rig file knows the lidar better than a cloud's header.
  if (!inputs.rig_file.empty()) {
    RAYFIELD_ASSIGN(options.beam, formats::read_rig_beam(inputs.rig_file));
  }
  RAYFIELD_ASSIGN(const tile::Snapshot latest, store.latest());
  const std::string replaced = id_of_same_name(latest, options);
  std::vector<std::unique_ptr<RaySource>> parts;
  std::vector<std::string> warnings;
  const auto say = [&](const std::optional<std::string>& warning) {
    if (warning) progress.warn(*warning), warnings.push_back(*warning);
  };
  say(said_of_repeated(options.inputs, inputs.files.size(), latest, replaced));
  const std::string& crs = store.config().crs;
  RAYFIELD_ASSIGN(const CloudTrajectory trajectory, read_cloud_trajectory(inputs, crs, options.memory_bytes, progress));
  options.memory_bytes -= trajectory.bytes();
  for (const std::string& warning : trajectory.warnings) say(warning);
  std::vector<std::string> notes;
  for (const fs::path& path : inputs.files) {
    std::unique_ptr<RaySource> part;
    if (is_log(path)) {
      RAYFIELD_ASSIGN(part, open_log_rays(path, inputs, crs, store.folder(), options.threads, progress, warnings,
                                          options.attachments, options.beam));
    } else {
      RAYFIELD_ASSIGN(OpenedCloud cloud, open_cloud(path, inputs, crs, trajectory, progress));
      add_knowledge(cloud.beam, options.beam);
      notes.insert(notes.end(), cloud.notes.begin(), cloud.notes.end());
      part = std::move(cloud.rays);
    }
    RAYFIELD_ASSIGN(const auto warning, check_scan_place(*part, crs, latest, replaced));
    say(warning);
    parts.push_back(std::move(part));
  }
  JoinedSource rays(std::move(parts), warnings);
  RAYFIELD_ASSIGN(const auto restored, density::MissingRaySource::create(rays, {}));
  RaySource& source = inputs.restore_missing ? static_cast<RaySource&>(*restored) : rays;
  RAYFIELD_ASSIGN(const ScanPlacement placement, place(store, source, inputs, options, progress));
  options.alignment = placement.record;
  options.attachments.push_back({"alignment.json", alignment_file(placement)});
  PlacedSource placed(source, latest, replaced);
  DatedSource dated(placed, options.date, crs);
  const auto aligned = placement.alignment ? align::open_aligned(dated, *placement.alignment) : nullptr;
  Result<tile::AddReport> report = store.add(aligned ? *aligned : static_cast<RaySource&>(dated), options, progress);
  if (report) return AddedScan{std::move(*report), placement.record, std::move(warnings), std::move(notes)};
  if (report.error().code == ErrorCode::bad_input)
    for (const std::string& warning : rays.warnings()) report.error().why += " (" + warning + ")";
  return tl::make_unexpected(std::move(report).error());
}

}  // namespace rayfield::cli
