#pragma once

#include <string>

#include "cli/drives/drive_log.h"
#include "rayfield/core/grid2.h"

namespace rayfield::cli {

/// Plan view of a drive: hits per area, the trajectory, and the GPS fixes with those refused in red.
Result<void> write_drive_picture(const RegisteredDrive& drive, const Grid2<std::uint32_t>& hits,
                                 const std::string& path);

}  // namespace rayfield::cli
