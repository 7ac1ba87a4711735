#pragma once

#include <optional>
#include <string>

#include "rayfield/core/landmarks.h"
#include "rayfield/core/progress.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// Posts, trunks, ground and track as one scan of a store shows them, taken alone. Nothing is published.
/// Errors: bad_input (no rows found), usage (options), damaged, resources, locked, interrupted.
Result<BlockLandmarks> find_landmarks(tile::Store& store, const std::string& scan_id, const ProcessOptions& options,
                                      Progress& progress);

/// The landmarks that scans of this block are laid on: the layout in its registry, with the ground and the track of its
/// reference scan (else of the first). A block that has scans and no layout yet gets one from that scan, which is
/// published. A store without scans has those of its survey, if it has one. Errors: as find_landmarks().
Result<std::optional<BlockLandmarks>> reference_landmarks(tile::Store& store, const ProcessOptions& options,
                                                          const std::string& command, Progress& progress);

}  // namespace rayfield::density
