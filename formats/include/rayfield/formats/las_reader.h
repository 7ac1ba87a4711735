#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rayfield/core/ray_source.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/trajectory_file.h"

namespace rayfield::formats {

struct LasReadOptions {
  /// Of the sensor in the frame of the trajectory's body, m; zero: the trajectory is the sensor's own. Other than zero
  /// the trajectory needs an orientation.
  Eigen::Vector3d lever_arm_m = Eigen::Vector3d::Zero();
  /// Added to the times of the points to get those of the trajectory's clock, s (time.lidar_offset_s of a rig).
  double time_offset_s = 0;
  /// Poses that lie further apart leave a gap, 0 … 60 s: points measured in it are left out. One pose a second is just
  /// enough; a vehicle does not drive straight for longer.
  double max_gap_s = 1.1;
  /// How long before the first pose and behind the last a point may be measured, 0 … 1 s: trajectories are often
  /// written with three decimals. A vehicle at 1.5 m/s moves 1.5 cm in the default.
  double tolerance_s = 0.01;
  /// A file that ends before the points that its header announces: false refuses it and says how many complete points
  /// there are; true reads those and warns.
  bool allow_truncated = false;
  /// Bytes behind the last point that nothing in the header announces: false refuses them, true leaves them out.
  bool allow_trailing = false;
  /// Asked every megabyte; true ends read() with ErrorCode::interrupted.
  std::function<bool()> cancelled = nullptr;

  Result<void> validate() const;
};

/// Reads a LAS file (ASPRS LAS 1.2 to 1.4, point formats 1 and 3 to 10, uncompressed) with the trajectory of its drive
/// as a stream of rays (docs/ray-cloud-las.md): a ray begins where the sensor was when its first return was measured
/// and ends at that. All rays are hits, since LAS has no place for others. Left out and counted in warnings(): later
/// returns of a pulse, points that are withheld, synthetic or noise (classes 7, 18), points measured outside of the
/// trajectory or in a gap of it, points whose time is not finite, that lie beyond ±1e8 m, at the sensor, or more than
/// 2 km from it.
class LasReader : public RaySource {
 public:
  /// Reads the header and looks at some points: how their times belong to those of the trajectory
  /// (formats/las/time_match.h), and whether they lie near it. `trajectory` is shared, not copied; times strictly
  /// increasing. Errors: usage (options; a lever arm without orientation); bad_input with path and offset (not LAS,
  /// versions and formats that are not read, LAZ, fewer than two poses, header and size contradict each other, no point
  /// was measured during the trajectory, points in other coordinates than the trajectory); resources.
  static Result<std::unique_ptr<LasReader>> open(const std::string& path,
                                                 std::shared_ptr<const TrajectoryFile> trajectory,
                                                 const LasReadOptions& options = {});
  ~LasReader() override;

  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override;
  Result<bool> rewind() override;
  /// Points in the file, those that will be left out included.
  std::optional<std::uint64_t> ray_count() const override;
  std::string name() const override;
  std::vector<std::string> warnings() const override;

  /// "EPSG:7854", or WKT where PROJ knows no code for it; nothing where the file names none.
  std::optional<std::string> crs() const;
  /// The same for people: the code, or the name that the WKT has.
  std::string crs_name() const;
  /// What was assumed of the clocks, and where the sensor stands in the body's frame; a line each.
  std::vector<std::string> notes() const;

 private:
  struct Impl;
  explicit LasReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayfield::formats
