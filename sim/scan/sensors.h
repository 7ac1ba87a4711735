#pragma once

#include <vector>

#include "rayfield/core/sensor_log.h"
#include "rayfield/sim/drive.h"
#include "rayfield/sim/world.h"

/// Messages of the small sensors over a whole drive, in the order of their stamps.
namespace rayfield::sim {

/// Angular velocity and specific force with bias (constant plus random walk) and white noise.
std::vector<ImuSample> simulate_imu(const World& world, const Drive& drive);
/// The encoder's angle, wrapped to (−π, π]; empty for a fixed lidar.
std::vector<SpinnerAngle> simulate_spinner(const World& world, const Drive& drive);
/// Fixes of the antenna with a Gauss–Markov bias, white noise, jumps; none during outages.
std::vector<GpsFix> simulate_gps(const World& world, const Drive& drive);

}  // namespace rayfield::sim
