#pragma once

#include <string>
#include <string_view>

#include "rayfield/core/lidar_beam.h"

namespace rayfield::formats {

/// The beam of a lidar as its data sheet states it, by model: "LMS511", "SICK LMS511" and "lms-511" are the same.
/// Null where the model is not known.
const LidarBeam* beam_of_model(std::string_view model);

/// The known models, for messages and documentation.
std::string known_lidar_models();

/// The model that a topic or frame id names at the beginning of a word ("/os1_cloud_node/points", "vlp-16"); empty:
/// none.
std::string_view model_in_name(std::string_view name);

}  // namespace rayfield::formats
