#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <random>
#include <vector>

#include "libdensity/layout/row_layout.h"
#include "libdensity/voxels/wood.h"
#include "rayfield/tile/segments.h"

/// A hedge of square leaves on a plane, scanned from a lane on each side by a spinning 2-D lidar, with its own ray
/// caster (uniform grid, exact ray-square tests): an independent world for the estimators. The row runs along +x from
/// x = 0, z is up from the ground plane z = slope_x·x + slope_y·y.
namespace rayfield::density::testing {

struct HedgeOptions {
  double length_m = 9;
  double leaf_size_m2 = 0.0035;                   ///< of one leaf
  double leaf_area_per_m = 3;                     ///< mean, m² per metre of row
  double variation = 0.35;                        ///< relative, of leaf_area_per_m along the row (period 4.5 m)
  double sigma_across_m = 0.14;                   ///< normal distribution across
  double bottom_m = 0.9, top_m = 1.9;             ///< uniform in height, edges softened by 8 cm
  bool shoots = false;                            ///< leaves stand on upright shoots instead of independently
  double missing_from_m = -1, missing_to_m = -1;  ///< no leaves there
  double slope_x = 0, slope_y = 0;
  double post_every_m = 0;  ///< 0 = no posts
  double post_radius_m = 0.05, post_height_m = 1.9;
  std::uint64_t seed = 1;
};

struct ScanOptions {
  double lane_distance_m = 1.375;  ///< of both lanes from the row
  double sensor_height_m = 1.7;
  double speed_m_s = 1.2;
  double beams_per_s = 28600, lines_per_s = 100, spin_hz = 0.5;
  double range_noise_m = 0.012;
  bool both_sides = true;
  bool everything = false;  ///< keep the rays that pass the hedge by, too (ground, sky, road)
  std::uint64_t seed = 7;
};

struct Leaf {
  Eigen::Vector3d center, half_u, half_v;
};

class Hedge {
 public:
  explicit Hedge(const HedgeOptions& options);
  const HedgeOptions& options() const { return options_; }
  /// One-sided leaf area with the leaf's centre between two chainages, m².
  double leaf_area(double from_m, double to_m) const;
  const std::vector<Leaf>& leaves() const { return leaves_; }
  std::vector<WoodCylinder> posts() const;
  /// Distance to the first surface along a unit direction, or a negative number.
  double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  double ground(double x, double y) const { return options_.slope_x * x + options_.slope_y * y; }

  /// Rays of a drive along both lanes; those that miss the hedge's surroundings are left out.
  tile::SegmentBatch scan(const ScanOptions& scan) const;
  /// Row-aligned voxels over the hedge and 0.6 m beyond its ends.
  std::vector<RowSegment> row_segments(double voxel_m, double half_width_m, double top_m) const;

 private:
  void add_leaf(const Eigen::Vector3d& center, std::mt19937_64& rng);
  void build_grid();
  HedgeOptions options_;
  std::vector<Leaf> leaves_;
  Eigen::AlignedBox3d box_;
  int n_[3] = {0, 0, 0};
  std::vector<std::uint32_t> cell_start_, cell_leaf_;
};

}  // namespace rayfield::density::testing
