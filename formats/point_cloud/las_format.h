#pragma once

#include <memory>

#include "formats/point_cloud/point_format.h"

namespace rayfield::formats {

/// LAS 1.4 (ASPRS, revision R15, 2019), coordinates in units of 0.1 mm. Errors: usage (the CRS has no WKT, the date is
/// none).
Result<std::unique_ptr<PointFormat>> make_las_format(const PointCloudOptions& options);

}  // namespace rayfield::formats
