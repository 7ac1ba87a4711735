#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::slam {

/// Planar patches from lidar points.
struct SurfelOptions {
  /// Edge of the voxels of each resolution, m, 0.05–5. Small ones see posts and trunks, large ones ground and walls far
  /// away. Each resolution is laid twice, staggered by half a voxel.
  std::vector<double> voxel_size_m = {0.3, 0.6, 1.2};
  /// Points of one surfel come from one bin of this length, s, 0.05–2: at most half a sweep of the spinner.
  double time_bin_s = 0.5;
  int min_points = 6;                  ///< per voxel, ≥ 4
  double max_eigenvalue_ratio = 0.15;  ///< planarity: smallest / middle eigenvalue, 0–1
  double min_extent_fraction = 0.08;   ///< root of the middle eigenvalue as a fraction of the voxel's edge, 0–0.3
  int max_surfels_per_bin = 400;       ///< of each resolution; bounds memory and time, ≥ 50
  Result<void> validate() const;
};

/// Pairs of surfels that show the same surface at different times.
struct MatchOptions {
  /// Largest distance in position–normal space, as a multiple of the voxel's edge: first and last iteration.
  double first_radius_voxels = 1.2, last_radius_voxels = 0.7;
  /// Metres that count as much as a unit difference of normals (57°), > 0.
  double normal_scale_m = 0.5;
  double min_time_gap_s = 0.7;  ///< surfels closer in time are the same observation, > 0
  /// Standard deviation of the offset between two surfels of one flat surface, m, > 0.
  double sigma_m = 0.005;
  /// Cauchy scale in standard deviations: first and last iteration (annealed), > 0.
  double first_cauchy = 4.0, last_cauchy = 1.0;
  Result<void> validate() const;
};

/// Stage a: non-rigid registration in a sliding window.
struct WindowOptions {
  double length_s = 5.0;     ///< 2–20
  double advance_s = 1.0;    ///< a multiple of the surfels' time bin, ≤ length_s / 2
  double knot_step_s = 0.2;  ///< spacing of the correction spline, 0.05–1
  int first_iterations = 25;
  int max_iterations = 5;
  double converged_m = 5e-4;  ///< largest correction that ends the iterations
  Result<void> validate() const;
};

/// Posts and trunks as landmarks of the global stage.
struct PoleOptions {
  // A sighting: a voxel of the smallest resolution in one time bin.
  int min_points = 5;                  ///< ≥ 4
  double max_spread_m = 0.035;         ///< of its points, horizontal standard deviation, 0.005–0.2
  double min_upright_fraction = 0.18;  ///< of the voxel's edge: their vertical standard deviation, 0.05–0.28
  double max_around = 0.2;             ///< points in the voxels around it, as a share of its own, 0–2
  double max_range_m = 8;              ///< horizontal, from the sensor, 1–50
  // A visit: the sightings of one slice in one pass.
  double slice_m = 0.25;   ///< of height: poles lean, 0.05–5
  double gather_m = 0.12;  ///< horizontal, 0.02–0.5
  double max_pause_s = 3;  ///< between two sightings, 0.5–60
  // Pairs of visits.
  double reach_m = 0.1;      ///< between the axes of two visits, besides the slack of revisits; 0.01–0.5
  double max_reach_m = 0.4;  ///< the same with the slack, ≥ reach_m, ≤ 2
  /// Standard deviation of the axis of a visit in either direction, besides the scatter of its scan lines on the pole;
  /// that of the depth from pole to pole. m, > 0.
  double sigma_m = 0.006, thickness_sigma_m = 0.006;
  /// From the visible surface of poles to their axis before it is estimated, 0–0.5 m, and its standard deviation, > 0.
  double depth_m = 0.02, depth_sigma_m = 0.02;
  /// How often a pair counts in the solution: surfels are given more weight than is honest there, too (docs/slam.md).
  /// 0: poles are not used; ≤ 100.
  double weight = 3;
  Result<void> validate() const;
};

/// Stage b: global registration of the whole drive.
struct GlobalOptions {
  double knot_step_s = 1.0;     ///< spacing of the correction spline, 0.2–2
  int odometry_iterations = 4;  ///< before revisits are matched
  int revisit_iterations = 8;   ///< with revisits and GPS
  int release_iterations = 12;  ///< at most, with revisits, GPS released
  double converged_m = 0.01;    ///< largest correction that ends these iterations, 1e-4–1
  /// Revisits at most this far apart in time are matched first, 20–1000; the limit grows by this factor with every
  /// iteration, 1.05–2.
  double first_gap_s = 60, gap_growth = 1.2;
  /// How far lanes may be apart after stage a, m: scale of the weights of revisits in their first iteration. It shrinks
  /// to nothing; 0.01–2.
  double first_slack_m = 0.3;
  /// Most knots of a long drive, whose spacing grows: while revisits are still far apart, 50–2000, and in the end.
  int coarse_knots = 250, fine_knots = 1200;
  /// Thicker surfaces (foliage) bring lanes near to each other, but the result does not rest on them: m, standard
  /// deviation, > 0.
  double max_revisit_thickness_m = 0.02;
  /// Standard deviation of the offset between two surfels of one flat surface, m, > 0, and the part of the variance of
  /// their layers that adds to it, 0–1: a centre is the mean of ten points or more. As measured; the uncertainties
  /// reported take MatchOptions::sigma_m and all of the layers.
  double sigma_m = 0.0025, layer_share = 0.1;
  double revisit_gap_s = 10.0;  ///< matches further apart in time are revisits, > the window's length
  /// Matches further apart than half of this are refused where GPS holds the drive: the next row looks the same.
  double row_spacing_m = 2.0;
  double bias_step_s = 10.0;  ///< spacing of the nodes between which sensor biases are linear
  Result<void> validate() const;
};

/// Use of position fixes.
struct GpsOptions {
  double min_sigma_m = 0.3;        ///< floor of a fix's standard deviation (receivers are optimists), > 0
  double correlation_time_s = 30;  ///< of the receiver's wandering bias: fixes within it count as one
  double min_baseline_m = 8;       ///< the drive must span this much before yaw is taken from GPS
  int min_fixes = 20;
  double max_residual_m = 3.5;  ///< median offset above which drive and GPS contradict each other: the run fails
  Result<void> validate() const;
};

/// Everything that can be set. Defaults suit a 2-D lidar spinning at 0.5 Hz on a vehicle at walking to driving pace in
/// a vineyard, and 3-D lidars with more beams.
struct SlamOptions {
  SurfelOptions surfels;
  MatchOptions match;
  WindowOptions window;
  PoleOptions poles;
  GlobalOptions global;
  GpsOptions gps;
  /// A window whose mean position lidar alone knows worse than this in some direction is reported as degenerate, m.
  double degenerate_sigma_m = 0.1;
  double max_thickness_m = 0.025;  ///< surfaces thicker than this after registration: the drive failed
  double max_imu_gap_s = 0.5;      ///< a longer gap ends the drive: no trajectory is made across it
  int max_points_per_bin = 30000;  ///< lidar points used per time bin; denser lidars are thinned evenly, ≥ 1000
  /// Folder for a temporary file without a name, which holds what does not fit in memory: 0.15 MB per second of
  /// driving. Empty: that of the system, which may be in memory itself.
  std::string scratch;
  int threads = 0;  ///< 0: all processors; does not change the result
  std::filesystem::path scratch_directory() const;
  Result<void> validate() const;
};

}  // namespace rayfield::slam
