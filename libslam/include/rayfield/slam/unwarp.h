#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rayfield/core/grid2.h"
#include "rayfield/core/ray.h"
#include "rayfield/core/ray_source.h"
#include "rayfield/core/rig.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/slam/trajectory.h"

namespace rayfield::slam {

/// Takes rays in the order in which they were measured.
using RayTaker = std::function<Result<void>(const RayBatch&)>;

/// Clock and encoder corrections that come on top of the rig file's.
struct SensorOffsets {
  double lidar_s = 0;      ///< added to lidar stamps
  double spinner_rad = 0;  ///< added to the encoder angle
};

/// What was kept and what was left out.
struct UnwarpCounts {
  std::uint64_t rays = 0, hits = 0;
  std::uint64_t downward_no_return = 0;    ///< nothing came back and the beam pointed down: length unknown
  std::uint64_t invalid = 0;               ///< NaN, too close
  std::uint64_t outside_trajectory = 0;    ///< measured where there is no pose
  std::uint64_t without_angle = 0;         ///< scans that the spinner's encoder does not cover
  std::vector<std::string> lines() const;  ///< one line per kind that occurred
};

/// Turns a log into rays with a given trajectory, one point at a time at its own time (paper, SLAM: p_G = T(τ) ⊕ p_S).
/// Rays without a return: upward ones (rising in the map) become rays of max_range_m without a hit, downward ones are
/// dropped (method: 1). Lengths on the ground become grid lengths by trajectory.horizontal_scale.
/// Usage: feed messages, then finish(). The first error of the taker stops the work and is returned by finish().
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

/// The rays of a log as a stream that can be read again: each pass reads the log in a thread of its own, at most a few
/// batches ahead. `trajectory` is shared, not copied.
std::unique_ptr<RaySource> open_unwarped(LogReader read, const Rig& rig, std::shared_ptr<const Trajectory> trajectory,
                                         const SensorOffsets& offsets, std::string name);

/// A grid over the trajectory and the reach of its lidar for plan views, hits per cell; at most 4000 × 4000 cells (the
/// cell grows if need be).
Grid2<std::uint32_t> plan_grid(const Trajectory& trajectory, double reach_m, double cell_m);
void add_hits(Grid2<std::uint32_t>& grid, const RayBatch& rays);

}  // namespace rayfield::slam
