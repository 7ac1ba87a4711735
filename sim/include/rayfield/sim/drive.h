#pragma once

#include <memory>
#include <vector>

#include "rayfield/core/rigid3.h"
#include "rayfield/sim/world.h"

namespace rayfield::sim {

class TrueTrajectory;

/// One drive through the block.
struct Drive {
  double start_time_s = 0;                           ///< Unix time of the start of the log: midnight UTC of the date
  std::shared_ptr<const TrueTrajectory> trajectory;  ///< of the IMU in ENU; its times count from the start of the log
  std::vector<int> lanes;                            ///< in the order in which they were driven
  double path_m = 0;                                 ///< length of the path over ground

  double duration_s() const;
  /// True poses (enu_from_imu, Unix times) from the start, `rate_hz` a second.
  std::vector<TimedPose> poses(double rate_hz) const;
};

/// Plans the date's drive: stands still, then drives the lanes in order, every next one in the other direction, with
/// turns in the headlands; wander, uneven speed, suspension and vibration follow from the date's seed.
/// Errors: usage where the drive would take longer than a day.
Result<Drive> plan_drive(const World& world);

}  // namespace rayfield::sim
