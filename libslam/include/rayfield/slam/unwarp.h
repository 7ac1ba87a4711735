#pragma once

#include <memory>
#include <string>

#include "rayfield/core/ray_source.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/slam/trajectory.h"

namespace rayfield::slam {

/// Clock and encoder corrections in addition to those of the rig file.
struct SensorOffsets {
  double lidar_s = 0;      ///< added to lidar stamps
  double spinner_rad = 0;  ///< added to the encoder angle
};

/// The rays of a log as a stream that can be read again: each pass reads the log in a thread of its own, at most a few
/// batches ahead. `trajectory` is shared, not copied.
std::unique_ptr<RaySource> open_unwarped(LogReader read, const Rig& rig, std::shared_ptr<const Trajectory> trajectory,
                                         const SensorOffsets& offsets, std::string name);

}  // namespace rayfield::slam
