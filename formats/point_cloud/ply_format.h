#pragma once

#include <memory>

#include "formats/point_cloud/point_format.h"

namespace rayfield::formats {

/// Binary little-endian PLY; coordinates are doubles.
Result<std::unique_ptr<PointFormat>> make_ply_format(const PointCloudOptions& options);

}  // namespace rayfield::formats
