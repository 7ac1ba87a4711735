/// unwarp: from a log and a trajectory to rays in the map frame, and to a plan view.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rayfield/core/ray.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/slam/trajectory.h"
#include "rayfield/slam/unwarp.h"

namespace rayfield::slam {

/// Takes rays in the order in which they were measured.
using RayTaker = std::function<Result<void>(const RayBatch&)>;

/// What was kept and what was left out.
struct UnwarpCounts {
  std::uint64_t rays = 0, hits = 0;
  std::uint64_t downward_no_return = 0;    ///< dropped: nothing came back and the beam pointed down
  std::uint64_t downward_kept = 0;         ///< of the rays: the same of lidars with several beams
  std::uint64_t stopped_by_vehicle = 0;    ///< pointed down, where hardly anything comes back (OpenDirections)
  std::uint64_t invalid = 0;               ///< NaN, too close
  std::uint64_t outside_trajectory = 0;    ///< measured where there is no pose
  std::uint64_t without_angle = 0;         ///< scans that the spinner's encoder does not cover
  std::vector<std::string> lines() const;  ///< one line per kind that occurred
};

/// Turns a log into rays with a given trajectory, every point at its own time (paper, SLAM: p_G = T(τ) ⊕ p_S).
/// Rays without a return become rays of max_range_m without a hit. Upward ones (rising in the map) are empty up to
/// there, downward ones down to the ground, which returned nothing, being met aslant. Of scanners that turn one beam in
/// a plane these are dropped, as in clouds from elsewhere: MissingRaySource finds them between the others. Of lidars
/// with several beams it cannot, and they are kept, but in directions from which hardly anything ever comes back, where
/// a part of the vehicle stops them. Lengths on the ground become grid lengths by trajectory.horizontal_scale. Usage:
/// feed messages, then finish(). The first error of the taker stops the work and is returned by finish().
class Unwarper : public SensorSink {
 public:
  Unwarper(const Rig& rig, const Trajectory& trajectory, const SensorOffsets& offsets, RayTaker take,
           std::size_t batch_rays = 65536);
  ~Unwarper() override;

  void spinner(const SpinnerAngle& angle) override;
  void lidar(const LidarScan& scan) override;
  Result<void> finish();
  const UnwarpCounts& counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayfield::slam
