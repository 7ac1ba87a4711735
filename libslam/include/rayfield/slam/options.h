#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rayfield/core/option_fields.h"
#include "rayfield/core/result.h"

/// options: everything that can be set. Members give defaults; visit_fields() gives ranges and meanings
/// (docs/options.md). Defaults suit a 2-D lidar spinning at 0.5 Hz on a vehicle at walking to driving pace in a
/// vineyard, and 3-D lidars with more beams.
namespace rayfield::slam {

/// Planar patches from lidar points.
struct SurfelOptions {
  std::vector<double> voxel_size_m = {0.3, 0.6, 1.2};
  double time_bin_s = 0.5;
  int min_points = 6;
  double max_eigenvalue_ratio = 0.15;
  double min_extent_fraction = 0.08;
  int max_surfels_per_bin = 400;
  double max_spot_depth_m = 0;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.numbers("voxel_size_m", o.voxel_size_m, {0.05, 5}, 8,
              "Voxel edges, one per resolution, each laid twice with half a voxel between; small ones see posts and "
              "trunks, large ones ground and distant walls");
    v.number("time_bin_s", o.time_bin_s, {0.05, 2},
             "The points of one surfel come from one time bin: at most half a sweep of the spinner");
    v.integer("min_points", o.min_points, {4, 1000}, "Points that a voxel needs to become a surfel");
    v.number("max_eigenvalue_ratio", o.max_eigenvalue_ratio, {1e-6, 1},
             "Planarity: smallest over middle eigenvalue of the points' covariance; smaller = flatter surfels only");
    v.number("min_extent_fraction", o.min_extent_fraction, {0, 0.3},
             "Root of the middle eigenvalue as a fraction of the voxel edge; excludes single scan lines");
    v.integer("max_surfels_per_bin", o.max_surfels_per_bin, {50, 100000},
              "Surfels kept per time bin and resolution; bounds memory and time");
    v.number("max_spot_depth_m", o.max_spot_depth_m, {0, 10},
             "Planes on which the spot of a wide beam reaches further than this along the beam make no surfels: beyond "
             "the lidar's range resolution what returns is the near edge of the spot; "
             "0 = measured from the drive, see docs/slam.md");
  }
};

/// Pairs of surfels that show the same surface at different times.
struct MatchOptions {
  double first_radius_voxels = 1.2, last_radius_voxels = 0.7;
  double normal_scale_m = 0.5;
  double min_time_gap_s = 0.7;
  double sigma_m = 0.005;
  double first_cauchy = 4.0, last_cauchy = 1.0;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("first_radius_voxels", o.first_radius_voxels, {0.1, 10},
             "Largest distance of a match in position-normal space, in voxel edges, in the first iteration");
    v.number("last_radius_voxels", o.last_radius_voxels, {0.1, 10},
             "The same in the last iteration; not larger than first_radius_voxels");
    v.number("normal_scale_m", o.normal_scale_m, {1e-3, 100},
             "Distance that counts as much as a unit difference of normals (57 degrees)");
    v.number("min_time_gap_s", o.min_time_gap_s, {0.01, 10}, "Surfels closer in time are the same observation");
    v.number("sigma_m", o.sigma_m, {1e-4, 1}, "Standard deviation of the offset between two surfels of a flat surface");
    v.number("first_cauchy", o.first_cauchy, {0.1, 100},
             "Scale of the Cauchy weights in standard deviations, in the first iteration");
    v.number("last_cauchy", o.last_cauchy, {0.1, 100}, "The same in the last iteration; not larger than first_cauchy");
  }
};

/// Stage a: non-rigid registration in a sliding window.
struct WindowOptions {
  double length_s = 5.0;
  double advance_s = 1.0;
  double knot_step_s = 0.2;
  int first_iterations = 25;
  int max_iterations = 5;
  double converged_m = 5e-4;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("length_s", o.length_s, {2, 20}, "Length of the window");
    v.number("advance_s", o.advance_s, {0.1, 10},
             "Step between windows: a multiple of surfels.time_bin_s and at most half of length_s; larger = faster");
    v.number("knot_step_s", o.knot_step_s, {0.05, 1}, "Knot spacing of the correction spline");
    v.integer("first_iterations", o.first_iterations, {1, 1000}, "Most iterations of the first window");
    v.integer("max_iterations", o.max_iterations, {1, 1000}, "Most iterations of every later window");
    v.number("converged_m", o.converged_m, {0, 0.1}, "Iterations end when no knot moves by more than this");
  }
};

/// Posts and trunks as landmarks of the global registration. A detection is a voxel of the smallest resolution in one
/// time bin, an observation the detections of one height slice in one pass; pairs of observations tie passes together.
struct PoleOptions {
  int min_points = 5;
  double max_spread_m = 0.035;
  double min_upright_fraction = 0.18;
  double max_around = 0.2;
  double max_range_m = 8;
  double slice_m = 0.25;
  double gather_m = 0.12;
  double max_pause_s = 3;
  double reach_m = 0.1, max_reach_m = 0.4;
  double sigma_m = 0.006, thickness_sigma_m = 0.006;
  double depth_m = 0.02, depth_sigma_m = 0.02;
  double weight = 3;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.integer("min_points", o.min_points, {4, 1000}, "Points that a voxel needs to be a detection");
    v.number("max_spread_m", o.max_spread_m, {0.005, 0.2}, "Largest horizontal standard deviation of its points");
    v.number("min_upright_fraction", o.min_upright_fraction, {0.05, 0.28},
             "Least vertical standard deviation of its points, as a fraction of the voxel edge");
    v.number("max_around", o.max_around, {0, 2}, "Most points in the surrounding voxels, as a share of its own");
    v.number("max_range_m", o.max_range_m, {1, 50}, "Largest horizontal distance of a detection from the sensor");
    v.number("slice_m", o.slice_m, {0.05, 5}, "Height of the slices that are observed separately, since poles lean");
    v.number("gather_m", o.gather_m, {0.02, 0.5}, "Largest horizontal distance between detections of one observation");
    v.number("max_pause_s", o.max_pause_s, {0.5, 60}, "Longest pause between two detections of one observation");
    v.number("reach_m", o.reach_m, {0.01, 0.5},
             "Largest horizontal distance between the axes of a pair, apart from the slack of loop closures");
    v.number("max_reach_m", o.max_reach_m, {0.01, 2}, "The same including the slack; at least reach_m");
    v.number("sigma_m", o.sigma_m, {1e-4, 1},
             "Standard deviation of an observed axis, apart from the scatter of its scan lines on the pole");
    v.number("thickness_sigma_m", o.thickness_sigma_m, {1e-4, 1}, "Standard deviation of the depth from pole to pole");
    v.number("depth_m", o.depth_m, {0, 0.5}, "Depth of the axis behind the visible surface before it is estimated");
    v.number("depth_sigma_m", o.depth_sigma_m, {1e-4, 1}, "Standard deviation of that depth");
    v.number("weight", o.weight, {0, 100},
             "How often a pair counts in the solution, whose surfels also weigh more than their independent share; "
             "0 = poles are not used");
  }
};

/// Stage b: global registration of the whole drive.
struct GlobalRegistrationOptions {
  double knot_step_s = 1.0;
  int odometry_iterations = 4;
  int revisit_iterations = 8;
  int release_iterations = 12;
  double converged_m = 0.01;
  double first_gap_s = 60, gap_growth = 1.2;
  double first_slack_m = 0.3;
  int coarse_knots = 250, fine_knots = 1200;
  double max_revisit_thickness_m = 0.02;
  // As measured: a centre is the mean of ten points or more. The uncertainties reported take MatchOptions::sigma_m and
  // the whole variance of the layers.
  double sigma_m = 0.0025, layer_share = 0.1;
  double revisit_gap_s = 10.0;
  double row_spacing_m = 2.0;
  double bias_step_s = 10.0;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("knot_step_s", o.knot_step_s, {0.2, 2}, "Knot spacing of the correction spline; grows on long drives");
    v.integer("odometry_iterations", o.odometry_iterations, {0, 100}, "Iterations before loop closures are matched");
    v.integer("revisit_iterations", o.revisit_iterations, {1, 100}, "Iterations with loop closures and GPS");
    v.integer("release_iterations", o.release_iterations, {0, 100},
              "Most iterations with loop closures after GPS is released");
    v.number("converged_m", o.converged_m, {1e-4, 1}, "These end when no knot moves by more than this");
    v.number("first_gap_s", o.first_gap_s, {20, 1000},
             "Loop closures at most this far apart in time are matched first");
    v.number("gap_growth", o.gap_growth, {1.05, 2}, "Factor by which that limit grows with every iteration");
    v.number(
        "first_slack_m", o.first_slack_m, {0.01, 2},
        "How far apart lanes may be after stage a: scale of the first weights of loop closures; shrinks to nothing");
    v.integer("coarse_knots", o.coarse_knots, {50, 2000}, "Most knots while lanes are still far apart");
    v.integer("fine_knots", o.fine_knots, {50, 10000}, "Most knots at the end; at least coarse_knots");
    v.number("max_revisit_thickness_m", o.max_revisit_thickness_m, {1e-4, 10},
             "Thicker surfaces (foliage) bring lanes together, but the result does not rest on them");
    v.number("sigma_m", o.sigma_m, {1e-4, 1}, "Standard deviation of the offset between two surfels of a flat surface");
    v.number("layer_share", o.layer_share, {0, 1}, "Share of the variance of the surfels' layers that adds to it");
    v.number("revisit_gap_s", o.revisit_gap_s, {2, 1000},
             "Matches further apart in time are loop closures; longer than window.length_s");
    v.number("row_spacing_m", o.row_spacing_m, {0.2, 100},
             "Matches further apart than half of this are rejected, since the next row looks the same");
    v.number("bias_step_s", o.bias_step_s, {1, 1000}, "Spacing of the nodes between which sensor biases are linear");
  }
};

/// Use of position fixes.
struct GpsOptions {
  double min_sigma_m = 0.3;
  double correlation_time_s = 30;
  double min_baseline_m = 8;
  int min_fixes = 20;
  double max_residual_m = 3.5;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("min_sigma_m", o.min_sigma_m, {1e-3, 100},
             "Floor of a fix's standard deviation; receivers state too small ones");
    v.number("correlation_time_s", o.correlation_time_s, {0, 1e4},
             "Correlation time of the receiver's wandering bias: fixes within it count as one");
    v.number("min_baseline_m", o.min_baseline_m, {0.1, 1e4}, "Extent that a drive needs for its yaw to come from GPS");
    v.integer("min_fixes", o.min_fixes, {2, 1e6}, "Fixes that a drive needs to be georeferenced");
    v.number("max_residual_m", o.max_residual_m, {0.1, 1e4},
             "Median offset of the fixes above which the run fails: drive and GPS contradict each other");
  }
};

struct SlamOptions {
  SurfelOptions surfels;
  MatchOptions match;
  WindowOptions window;
  PoleOptions poles;
  GlobalRegistrationOptions global;
  GpsOptions gps;
  double degenerate_sigma_m = 0.1;
  double max_thickness_m = 0.025;
  double max_imu_gap_s = 0.5;
  int max_points_per_bin = 30000;
  // How a run is carried out; neither changes the result.
  std::string scratch;
  int threads = 0;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.group("surfels", o.surfels);
    v.group("match", o.match);
    v.group("window", o.window);
    v.group("poles", o.poles);
    v.group("global", o.global);
    v.group("gps", o.gps);
    v.number("degenerate_sigma_m", o.degenerate_sigma_m, {1e-3, 10},
             "Windows whose mean position lidar alone knows worse than this in some direction are reported");
    v.number("max_thickness_m", o.max_thickness_m, {1e-3, 10},
             "Thickness of registered surfaces above which the run fails");
    v.number("max_imu_gap_s", o.max_imu_gap_s, {0.02, 5},
             "Longest gap in the IMU data that a trajectory is made across");
    v.integer("max_points_per_bin", o.max_points_per_bin, {1000, 1e7},
              "Lidar points used per time bin; denser lidars are thinned evenly");
    v.text("scratch", o.scratch,
           "Folder for an unnamed temporary file of 0.15 MB per second of driving; empty = that of the system, which "
           "may be in memory");
    v.integer("threads", o.threads, {0, 4096}, "Worker threads; 0 = all processors. Does not change the result");
  }

  /// Errors: usage, for a value out of its range or two that do not go together.
  Result<void> validate() const;
  std::filesystem::path scratch_directory() const;
};

}  // namespace rayfield::slam
