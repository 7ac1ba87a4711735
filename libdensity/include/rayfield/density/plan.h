#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/density/options.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// What process() would do with one scan.
struct ScanPlan {
  std::string scan_id;
  bool is_needed = false;        ///< something of it would be made; else it is as an earlier run has left it
  std::uint64_t disk_bytes = 0;  ///< of its new files, about
};

struct ProcessPlan {
  std::vector<ScanPlan> scans;  ///< in the order in which they would be processed
  bool layout_is_new = false;   ///< rows and panels would be looked for
  std::uint64_t disk_bytes() const;
};

/// Tells what process() would do, without the writer's lock and without reading a ray. Sizes are those of the scan that
/// was processed before, or of another one of the block by their tiles; of the first scan of a block they follow from
/// its tiles and rays (docs/commands.md, "Dry runs"). What a scan teaches about rows that are new can make
/// later scans necessary that the plan leaves out. Errors: as process(), locked and interrupted excepted.
Result<ProcessPlan> plan_process(const tile::Store& store, const ProcessOptions& options);

/// What processing one more scan of the block takes on disk, about: for a ray as much as the scans that `known` has of
/// it, or what the first scan of a block takes.
std::uint64_t expected_bytes(const tile::Snapshot& known, std::uint64_t rays);

}  // namespace rayfield::density
