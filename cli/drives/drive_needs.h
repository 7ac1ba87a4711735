#pragma once

#include <cstdint>

#include "cli/console/needs.h"
#include "cli/drives/drive_log.h"

namespace rayfield::cli {

/// Rays that a log gives at most: its returns, and the rays that met nothing.
std::uint64_t rays_of(const OpenedLog& log);

/// What registering it takes, without a place for its rays.
Needs registration_needs(const OpenedLog& log);

/// What `slam` takes: with its ray cloud.
Needs slam_needs(const OpenedLog& log);

}  // namespace rayfield::cli
