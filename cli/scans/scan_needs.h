#pragma once

#include <cstdint>

#include "cli/console/needs.h"
#include "cli/scans/add_scan.h"

namespace rayfield::cli {

/// A scan that is to be added: how much there is of it, and what it takes.
struct ScanNeeds {
  std::uint64_t rays = 0;  ///< at most
  std::size_t logs = 0;    ///< of its files; they are registered first
  Needs needs;
};

/// Reads logs once, trajectories, and of clouds only their headers. `known`: scans of the same block, which show how
/// much a ray takes; may be empty. Errors: those of reading the files; usage where a log has no rig file.
Result<ScanNeeds> scan_needs(const ScanInputs& inputs, const std::string& crs, const tile::Snapshot& known,
                             std::uint64_t memory_bytes, Progress& progress);

}  // namespace rayfield::cli
