#pragma once

#include "libdensity/leaf_angles/leaf_angle_fit.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

inline constexpr const char* kLeafAnglesKind = "leaf_angles";

/// Stored form: column "fit" of the fit's numbers.
tile::ArraySet arrays_from_leaf_angles(const LeafAngleFit& fit);

/// Also of earlier versions, which kept fewer numbers. Errors: damaged, where there is another number of them, or one
/// that cannot be.
Result<LeafAngleFit> leaf_angles_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
