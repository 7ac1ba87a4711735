#pragma once
/// blocks: the monthly update of a block, lists of blocks, and their references.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/products/export_block.h"
#include "cli/scans/add_scan.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/density/process.h"

namespace rayfield::cli {

/// The monthly job of one block.
struct BlockUpdate {
  std::filesystem::path store;
  std::string crs;  ///< of a store that is made where there is none; empty: there must be one
  ScanInputs inputs;
  std::string date, name;                       ///< of the scan
  std::optional<std::filesystem::path> output;  ///< folder of the products; none: nothing is exported
  std::vector<std::string> settings;            ///< of process, KEY=VALUE (docs/options.md)
};

/// How the program runs it.
struct UpdateOptions {
  bool overwrite = false;  ///< replace another scan of the same id, and a GeoPackage even if something is lost with it
  int threads = 0;
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  std::string command;  ///< for `rayfield log`
};

struct UpdateReport {
  AddedScan added;
  density::ProcessReport processed;
  std::optional<ExportReport> exported;
  std::uint64_t snapshot = 0;  ///< the newest one now
};

/// Registers, aligns and tiles the scan, processes what is not processed, and exports what is missing or changed. Each
/// step finds what is done: run again after a success, nothing is written; run again after a kill, the work goes on
/// and ends with the same bytes. Errors: those of the steps.
Result<UpdateReport> update_block(const BlockUpdate& block, const UpdateOptions& options, Progress& progress);

}  // namespace rayfield::cli
