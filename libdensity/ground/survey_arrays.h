#pragma once

#include "libdensity/ground/survey.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Stored form, kind "survey" version 2 (version 1 did not count misses, and is computed again).
tile::ArraySet survey_to_arrays(const TileSurvey& survey);
/// Errors: damaged, when columns are missing or do not fit together.
Result<TileSurvey> survey_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
