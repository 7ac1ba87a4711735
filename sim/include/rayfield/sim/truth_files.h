#pragma once

#include <filesystem>

#include "rayfield/core/result.h"
#include "rayfield/sim/truth.h"

namespace rayfield::sim {

/// Writes trajectory.tum, trajectory_map.tum, panels.csv, metres.csv, canopy.csv,
/// canopy_metres.csv, canopy_profile.csv, rows.csv, posts.csv, ground.csv and site.json
/// into `folder`, which is made if need be (formats: docs/simulation.md). Errors: resources, bad_input.
Result<void> write_truth(const Truth& truth, const std::filesystem::path& folder);

}  // namespace rayfield::sim
