#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>
/// report: what is reported of a run, as JSON for programs and as text for people.
namespace rayfield::slam {

/// Residuals of one kind at the end of the global registration.
struct ResidualSummary {
  std::uint64_t count = 0;
  double rms = 0;  ///< with the final robust weights
};

/// Horizontal offsets of the fixes from the antenna's path.
struct GpsSummary {
  std::uint64_t fixes = 0, used = 0;  ///< used: within the drive and not refused as invalid
  std::uint64_t outliers = 0;         ///< more than three robust standard deviations off: nearly without weight
  double longest_outage_s = 0;
  double median_offset_m = 0, p95_offset_m = 0, max_offset_m = 0;
  Eigen::Vector3d mean_offset_m = Eigen::Vector3d::Zero();   ///< east, north, up: antenna less fix
  double yaw_sigma_rad = 0;                                  ///< of the frame's orientation
  double release_shift_mean_m = 0, release_shift_max_m = 0;  ///< motion of the poses when GPS was released
};

/// A section where lidar alone does not determine the position along `direction` (east, north, up; unit).
struct DegenerateSpan {
  double start_s = 0, end_s = 0;  ///< Unix time
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  double sigma_m = 0;  ///< worst standard deviation of a window's position from lidar alone
};

/// Standard deviations of a pose relative to the pose in the middle of the drive (east, north, up; m and rad), from
/// the normal equations. The GPS's own bias, common to all poses, is not in them.
struct PoseSigma {
  double time_s = 0;
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero(), rotation_rad = Eigen::Vector3d::Zero();
};

struct StageTime {
  std::string name;
  double seconds = 0;
  double real_time_factor = 0;  ///< duration of the drive / seconds
};

/// An estimated clock or encoder correction.
struct OffsetEstimate {
  std::string name;  ///< "lidar_offset_s", "spinner_offset_rad", "gps_offset_s"
  double value = 0, sigma = 0;
};

/// The report of a run. Names are those of the keys in report_json().
struct SlamReport {
  double start_s = 0, end_s = 0;  ///< Unix time of the trajectory
  double length_m = 0;
  std::string crs;  ///< empty: local frame
  bool georeferenced = false;
  std::string frame_note;  ///< how the frame was found, or why nothing is georeferenced
  double stationary_start_s = 0;
  double initial_speed_m_s = 0;  ///< found by search if the drive did not begin at rest

  std::uint64_t lidar_scans = 0, lidar_points = 0, lidar_hits = 0, surfels = 0;
  int windows = 0;
  /// Of a wide beam: how far apart along the beam surfaces make one echo, from ground seen aslant, and the depth of
  /// spots up to which planes were used. NaN where not measured, or where the beam is not known.
  double range_resolution_m = std::numeric_limits<double>::quiet_NaN();
  double range_resolution_sigma_m = std::numeric_limits<double>::quiet_NaN();
  double max_spot_depth_m = std::numeric_limits<double>::quiet_NaN();
  ResidualSummary window_surfels_m, near_surfels_m, revisit_surfels_m, poles_m, gps_m, gyro_rad_s, accel_m_s2;
  double pole_depth_m = 0;          ///< from the visible surface of posts and trunks to their axes
  std::uint64_t loop_closures = 0;  ///< surfel matches between different passes
  std::uint64_t linked_visits = 0;  ///< pairs of 5 s sections that at least ten of them link
  double surfel_thickness_m = 0;    ///< robust standard deviation of flat surfaces seen in different passes; NaN: none
  /// Largest mean residual of the IMU over five seconds of straight driving, standard deviations: 1.2–1.9 in a correct
  /// map, more if a lane was mistaken for its neighbour.
  double imu_misfit = 0;
  /// Share of surfaces seen twice within a window of stage a that agree within three standard deviations: the lowest of
  /// all windows, and their median.
  double window_inliers_least = 0, window_inliers_typical = 0;
  /// Offsets between surfaces of different passes, 90th percentile over 20 s of driving: the largest of all sections,
  /// and their median, m. The two are similar in a correct map; 0 if there are too few.
  double visit_offset_worst_m = 0, visit_offset_typical_m = 0;
  GpsSummary gps;
  std::vector<DegenerateSpan> degenerate;
  std::vector<PoseSigma> uncertainty;
  std::vector<OffsetEstimate> offsets;
  Eigen::Vector3d gyro_bias_rad_s = Eigen::Vector3d::Zero(), accel_bias_m_s2 = Eigen::Vector3d::Zero();
  std::vector<StageTime> stages;
  std::vector<std::string> warnings;
};

/// The report as one JSON document (docs/slam.md names its keys). NaN becomes null.
std::string report_json(const SlamReport& report);

/// A summary of a few lines.
std::string report_summary(const SlamReport& report);

}  // namespace rayfield::slam
