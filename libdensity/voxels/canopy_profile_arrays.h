#pragma once

#include "libdensity/voxels/canopy_profile.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Stored form of a canopy profile, kind "profile" version 1.
tile::ArraySet profile_to_arrays(const CanopyProfile& profile);
/// Errors: damaged, naming what does not fit.
Result<CanopyProfile> profile_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
