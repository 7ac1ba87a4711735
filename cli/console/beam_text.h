#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "rayfield/core/lidar_beam.h"

namespace rayfield::cli {

/// "13.6 mm + 11.9 mrad", with what makes a return where it is known.
std::string beam_text(const LidarBeam& beam);
nlohmann::ordered_json beam_json(const LidarBeam& beam);

}  // namespace rayfield::cli
