#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "rayfield/core/lidar_beam.h"

namespace rayfield::formats {

/// "beam diameter_m 0.0136 divergence_rad 0.0119", followed by "detection_share 0.25" and "range_resolution_m 0.15"
/// where they are known. Numbers have as many digits as bring the same double back.
std::string beam_comment(const LidarBeam& beam);

/// The beam of such a comment; nothing where the comment is another, or its numbers make no beam.
std::optional<LidarBeam> parse_beam_comment(std::string_view comment);

}  // namespace rayfield::formats
