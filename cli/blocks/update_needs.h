#pragma once

#include <string>
#include <vector>

#include "cli/blocks/update_block.h"
#include "cli/console/needs.h"

namespace rayfield::cli {

/// What an update would do, and what it takes.
struct UpdateNeeds {
  bool makes_store = false;        ///< there is none yet
  bool already_there = false;      ///< the scan is
  std::uint64_t rays = 0;          ///< that would be added, at most
  std::vector<std::string> scans;  ///< of the store that would be processed, the new one left out
  Needs needs;
};

/// Reads the scan's logs once, no rays of clouds. Errors: those of the steps that update_block() takes.
Result<UpdateNeeds> update_needs(const BlockUpdate& block, const UpdateOptions& options, Progress& progress);

}  // namespace rayfield::cli
