#include "rayfield/slam/options.h"

#include <fmt/core.h>

#include <cmath>

namespace rayfield::slam {
namespace {

Result<void> in_range(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return fail(ErrorCode::usage, "cannot use SLAM option", name,
              fmt::format("{} is outside [{}, {}]", value, low, high));
}

}  // namespace

Result<void> SurfelOptions::validate() const {
  if (voxel_size_m.empty() || voxel_size_m.size() > 8)
    return fail(ErrorCode::usage, "cannot use SLAM option", "surfels.voxel_size_m", "1 to 8 sizes are needed");
  for (const double size : voxel_size_m) RAYFIELD_CHECK(in_range("surfels.voxel_size_m", size, 0.05, 5));
  RAYFIELD_CHECK(in_range("surfels.time_bin_s", time_bin_s, 0.05, 2));
  RAYFIELD_CHECK(in_range("surfels.min_points", min_points, 4, 1000));
  RAYFIELD_CHECK(in_range("surfels.max_eigenvalue_ratio", max_eigenvalue_ratio, 1e-6, 1));
  RAYFIELD_CHECK(in_range("surfels.min_extent_fraction", min_extent_fraction, 0, 0.3));
  return in_range("surfels.max_surfels_per_bin", max_surfels_per_bin, 50, 100000);
}

Result<void> MatchOptions::validate() const {
  RAYFIELD_CHECK(in_range("match.last_radius_voxels", last_radius_voxels, 0.1, 10));
  RAYFIELD_CHECK(in_range("match.first_radius_voxels", first_radius_voxels, last_radius_voxels, 10));
  RAYFIELD_CHECK(in_range("match.normal_scale_m", normal_scale_m, 1e-3, 100));
  RAYFIELD_CHECK(in_range("match.min_time_gap_s", min_time_gap_s, 0.01, 10));
  RAYFIELD_CHECK(in_range("match.sigma_m", sigma_m, 1e-4, 1));
  RAYFIELD_CHECK(in_range("match.last_cauchy", last_cauchy, 0.1, 100));
  return in_range("match.first_cauchy", first_cauchy, last_cauchy, 100);
}

Result<void> WindowOptions::validate() const {
  RAYFIELD_CHECK(in_range("window.length_s", length_s, 2, 20));
  RAYFIELD_CHECK(in_range("window.advance_s", advance_s, 0.1, length_s / 2));
  RAYFIELD_CHECK(in_range("window.knot_step_s", knot_step_s, 0.05, 1));
  RAYFIELD_CHECK(in_range("window.first_iterations", first_iterations, 1, 1000));
  RAYFIELD_CHECK(in_range("window.max_iterations", max_iterations, 1, 1000));
  return in_range("window.converged_m", converged_m, 0, 0.1);
}

Result<void> PoleOptions::validate() const {
  RAYFIELD_CHECK(in_range("poles.min_points", min_points, 4, 1000));
  RAYFIELD_CHECK(in_range("poles.max_spread_m", max_spread_m, 0.005, 0.2));
  RAYFIELD_CHECK(in_range("poles.min_upright_fraction", min_upright_fraction, 0.05, 0.28));
  RAYFIELD_CHECK(in_range("poles.max_around", max_around, 0, 2));
  RAYFIELD_CHECK(in_range("poles.max_range_m", max_range_m, 1, 50));
  RAYFIELD_CHECK(in_range("poles.slice_m", slice_m, 0.05, 5));
  RAYFIELD_CHECK(in_range("poles.gather_m", gather_m, 0.02, 0.5));
  RAYFIELD_CHECK(in_range("poles.max_pause_s", max_pause_s, 0.5, 60));
  RAYFIELD_CHECK(in_range("poles.reach_m", reach_m, 0.01, 0.5));
  RAYFIELD_CHECK(in_range("poles.max_reach_m", max_reach_m, reach_m, 2));
  RAYFIELD_CHECK(in_range("poles.sigma_m", sigma_m, 1e-4, 1));
  RAYFIELD_CHECK(in_range("poles.thickness_sigma_m", thickness_sigma_m, 1e-4, 1));
  RAYFIELD_CHECK(in_range("poles.depth_m", depth_m, 0, 0.5));
  RAYFIELD_CHECK(in_range("poles.depth_sigma_m", depth_sigma_m, 1e-4, 1));
  return in_range("poles.weight", weight, 0, 100);
}

Result<void> GlobalOptions::validate() const {
  RAYFIELD_CHECK(in_range("global.sigma_m", sigma_m, 1e-4, 1));
  RAYFIELD_CHECK(in_range("global.layer_share", layer_share, 0, 1));
  RAYFIELD_CHECK(in_range("global.knot_step_s", knot_step_s, 0.2, 2));
  RAYFIELD_CHECK(in_range("global.odometry_iterations", odometry_iterations, 0, 100));
  RAYFIELD_CHECK(in_range("global.revisit_iterations", revisit_iterations, 1, 100));
  RAYFIELD_CHECK(in_range("global.release_iterations", release_iterations, 0, 100));
  RAYFIELD_CHECK(in_range("global.converged_m", converged_m, 1e-4, 1));
  RAYFIELD_CHECK(in_range("global.first_gap_s", first_gap_s, 20, 1000));
  RAYFIELD_CHECK(in_range("global.gap_growth", gap_growth, 1.05, 2));
  RAYFIELD_CHECK(in_range("global.max_revisit_thickness_m", max_revisit_thickness_m, 1e-4, 10));
  RAYFIELD_CHECK(in_range("global.first_slack_m", first_slack_m, 0.01, 2));
  RAYFIELD_CHECK(in_range("global.coarse_knots", coarse_knots, 50, 2000));
  RAYFIELD_CHECK(in_range("global.fine_knots", fine_knots, coarse_knots, 10000));
  RAYFIELD_CHECK(in_range("global.revisit_gap_s", revisit_gap_s, 2, 1000));
  RAYFIELD_CHECK(in_range("global.row_spacing_m", row_spacing_m, 0.2, 100));
  return in_range("global.bias_step_s", bias_step_s, 1, 1000);
}

Result<void> GpsOptions::validate() const {
  RAYFIELD_CHECK(in_range("gps.min_sigma_m", min_sigma_m, 1e-3, 100));
  RAYFIELD_CHECK(in_range("gps.correlation_time_s", correlation_time_s, 0, 1e4));
  RAYFIELD_CHECK(in_range("gps.min_baseline_m", min_baseline_m, 0.1, 1e4));
  RAYFIELD_CHECK(in_range("gps.min_fixes", min_fixes, 2, 1e6));
  return in_range("gps.max_residual_m", max_residual_m, 0.1, 1e4);
}

Result<void> SlamOptions::validate() const {
  RAYFIELD_CHECK(surfels.validate());
  RAYFIELD_CHECK(match.validate());
  RAYFIELD_CHECK(window.validate());
  RAYFIELD_CHECK(poles.validate());
  RAYFIELD_CHECK(global.validate());
  RAYFIELD_CHECK(gps.validate());
  const double bins = window.advance_s / surfels.time_bin_s;
  if (std::abs(bins - std::round(bins)) > 1e-9 || bins < 1)
    return fail(ErrorCode::usage, "cannot use SLAM option", "window.advance_s",
                "it must be a whole multiple of surfels.time_bin_s");
  RAYFIELD_CHECK(in_range("degenerate_sigma_m", degenerate_sigma_m, 1e-3, 10));
  RAYFIELD_CHECK(in_range("max_thickness_m", max_thickness_m, 1e-3, 10));
  RAYFIELD_CHECK(in_range("max_imu_gap_s", max_imu_gap_s, 0.02, 5));
  return in_range("max_points_per_bin", max_points_per_bin, 1000, 1e7);
}

std::filesystem::path SlamOptions::scratch_directory() const {
  return scratch.empty() ? std::filesystem::temp_directory_path() : std::filesystem::path(scratch);
}

}  // namespace rayfield::slam
