#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

#include "libslam/surfels/surfel_file.h"
#include "libslam/trajectory/pose_track.h"
#include "rayfield/core/result.h"
#include "rayfield/core/spill_file.h"
#include "rayfield/slam/unwarp.h"

namespace rayfield::slam {

/// Offsets of the sensors that were found after the surfels were made.
struct SurfelOffsets {
  SensorOffsets sensors;
  Eigen::Vector3d spin_axis = Eigen::Vector3d::Zero();    ///< in the IMU frame
  Eigen::Vector3d spin_origin = Eigen::Vector3d::Zero();  ///< m
};
/// Moves a surfel to its right time and place. Times stay within the drive, [0, end_s].
void apply_offsets(const SurfelOffsets& offsets, double end_s, Surfel& surfel);

/// How surfels are divided into regions.
struct RegionOptions {
  double edge_m = 32;                ///< of the square regions
  double slack_m = 0.5;              ///< surfels may move so far before they are assigned anew
  std::vector<double> reach_m = {};  ///< of matches, for each level
};

/// A square of the world and what surrounds it.
struct SurfelRegion {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  std::vector<Surfel> surfels;    ///< in the order of the file, offsets applied
  std::vector<std::uint8_t> own;  ///< 1 for those in the square: of all regions exactly one owns a surfel
};

/// All surfels of a drive by their place in the world, on disk, so that memory does not grow with the drive. A region
/// has its own surfels and those around them up to twice the reach of a match: mutual_matches() over it finds those
/// matches of its own surfels that it would find over all. Errors: those of SpillFile.
class SurfelRegions {
 public:
  SurfelRegions(const std::filesystem::path& directory, RegionOptions options)
      : options_(std::move(options)), spill_(directory) {}

  /// Assigns the surfels to regions along `track` if that was not done yet or if some have moved by more than the slack
  /// since. Returns whether it did: regions and the indices in them are then different ones.
  Result<bool> update_layout(const SurfelFile& file, const PoseTrack& track, const SurfelOffsets& offsets, int threads);

  /// Regions are ordered by place.
  std::size_t count() const { return regions_.size(); }
  Result<void> load(std::size_t region, SurfelRegion& out) const;

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;  // y, x
  struct Region {
    std::vector<SpillFile::Extent> extents;
    std::vector<SurfelRecord> waiting;  // to be written
  };

  void remember(const PoseTrack& track, const SurfelOffsets& offsets);
  bool moved_too_far(const PoseTrack& track, const SurfelOffsets& offsets) const;
  Result<void> put(SurfelRecord record, const Eigen::Vector3f& place);
  Result<void> flush(Region& region);

  RegionOptions options_;
  SpillFile spill_;
  std::map<Key, Region> filling_;
  std::size_t waiting_ = 0;
  std::vector<std::pair<Key, Region>> regions_;
  SurfelOffsets offsets_;  // as last given
  double end_s_ = 0;
  // What the layout was made with: poses at every kPoseStep-th step of the track.
  std::vector<Rigid3> poses_;
  SensorOffsets laid_out_with_;
  double spin_rate_rad_s_ = 0;  // the fastest
};

}  // namespace rayfield::slam
