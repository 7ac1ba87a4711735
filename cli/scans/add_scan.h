#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/align/options.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

/// scans: ray clouds and logs on their way into a store: their date and place, their alignment, what they take.
namespace rayfield::cli {

/// What `rayfield add` is given.
struct ScanInputs {
  std::vector<std::filesystem::path> files;  ///< ray clouds (PLY, LAS) and logs, in the order of their times
  std::string rig_file;                      ///< of logs all of it, of clouds the lidar's beam, of LAS its mounting too
  std::string trajectory_file;               ///< of LAS clouds, which do not say where the sensor stood
  bool allow_truncated = false;              ///< take what is there of a cloud that was cut short
  bool restore_missing = true;               ///< put back the downward rays without a return that clouds leave out
  bool align = true;                         ///< lay it on the block's reference
  align::AlignOptions align_options = {};
};

/// Errors: usage where a log is given without a rig file.
Result<void> require_rig(const std::filesystem::path& log, const ScanInputs& inputs);

/// Names, sizes and digests of the files, those of the rig file and the trajectory among them: they decide what the
/// rays are. Errors: usage (a file twice; a trajectory is missing or in vain), those of reading.
Result<std::vector<tile::InputEntry>> describe_inputs(const ScanInputs& inputs, int threads, const Progress& progress);

/// A scan that was added.
struct AddedScan {
  tile::AddReport report;
  std::optional<tile::ScanAlignment> alignment;  ///< nothing for a scan that was there already
  std::vector<std::string> shown_warnings;       ///< those of the report's warnings that were shown when they arose
  std::vector<std::string> notes;                ///< what was assumed of clouds, see OpenedCloud
};

/// Adds clouds and logs (which are registered first) to a store as one scan. `options.inputs` is filled here.
Result<AddedScan> add_scan(tile::Store& store, const ScanInputs& inputs, tile::AddOptions options, Progress& progress);

}  // namespace rayfield::cli
