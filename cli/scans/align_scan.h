#pragma once

#include <optional>
#include <string>

#include "rayfield/align/align.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/store.h"

namespace rayfield::cli {

/// How a scan lies on its block: what the store keeps of it, and the move itself where it has to be moved.
struct ScanPlacement {
  tile::ScanAlignment record;
  std::optional<align::Alignment> alignment;
};

/// Lays the rays, which are read once and rewound, on the reference of the store's block: they are put into tiles of a
/// scratch store inside its folder, where posts, trunks and ground are found. The first scan of a store is the
/// reference itself. Errors: bad_input (another block, two places that fit alike, no rows found), others of
/// Store::add().
Result<ScanPlacement> place_scan(tile::Store& store, RaySource& rays, const align::AlignOptions& align_options,
                                 const tile::AddOptions& options, Progress& progress);

/// alignment.json, which is kept with the scan: the record, the warp, and the other places that were weighed, so that a
/// point of the log's own map can be moved as the scan was (docs/seasons.md).
std::string alignment_file(const ScanPlacement& placement);

}  // namespace rayfield::cli
