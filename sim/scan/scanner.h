#pragma once

/// scan: what the sensors measure on a drive: lidar messages and rays, IMU, encoder, GPS.

#include <optional>
#include <vector>

#include "rayfield/core/ray.h"
#include "rayfield/core/sensor_log.h"
#include "rayfield/sim/drive.h"
#include "rayfield/sim/simulate.h"
#include "rayfield/sim/world.h"
#include "sim/scan/beams.h"
#include "sim/scan/echoes.h"
#include "sim/scan/wide_beam.h"
#include "sim/world/map_from_enu.h"

namespace rayfield::sim {

/// The lidar of a drive, rendered in chunks of consecutive messages. A chunk is a pure function of its number, so
/// chunks may be rendered in any order and by any thread.
class Scanner {
 public:
  static Result<Scanner> create(const World& world, const Drive& drive);

  struct Chunk {
    std::vector<LidarScan> scans;
    RayBatch rays;
    SimulationSummary counts;
  };
  std::size_t chunk_count() const { return (scan_count_ + scans_per_chunk_ - 1) / scans_per_chunk_; }
  std::size_t scan_count() const { return scan_count_; }
  std::size_t beams_per_scan() const { return pattern_.direction.size(); }
  /// Rays can be left out where nobody wants them.
  void render(std::size_t chunk, bool want_rays, Chunk& out) const;

 private:
  Scanner(World world, Drive drive, const MapFromEnu& map)
      : world_(std::move(world)), drive_(std::move(drive)), map_(map) {}

  World world_;
  Drive drive_;
  MapFromEnu map_;
  BeamPattern pattern_;
  std::optional<WideBeam> wide_beam_;  // absent: beams are lines
  Rig rig_;
  Eigen::Matrix3d imu_from_spinner_, spinner_from_lidar_;
  std::size_t scan_count_ = 0, scans_per_chunk_ = 1;

  void render_scan(std::size_t index, bool want_rays, WideBeam::Bundle& bundle, Chunk& out) const;
  Shot shoot(double t, const Eigen::Vector3d& direction) const;
  std::optional<Echo> look(const Shot& shot, double t, std::uint64_t beam, WideBeam::Bundle& bundle) const;
  std::optional<Echo> look_along_line(const Shot& shot, double t, std::uint64_t beam) const;
  std::optional<Echo> look_with_width(const Shot& shot, double t, std::uint64_t beam, WideBeam::Bundle& bundle) const;
};

}  // namespace rayfield::sim
