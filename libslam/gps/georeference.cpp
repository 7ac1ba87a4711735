#include "libslam/gps/georeference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "rayfield/core/median.h"

namespace rayfield::slam {
namespace {

constexpr double kUnknownSigma = 2.0;  // m, of a fix that does not state its own
constexpr double kFrameStep = 50.0;    // m between evaluations of the map's Jacobian

double sigma_of(const GpsFix& f, double variance, const GpsOptions& options) {
  const bool stated = f.covariance_type != 0 && variance > 1e-8 && variance < 1e4;
  return std::max(options.min_sigma_m, stated ? std::sqrt(variance) : kUnknownSigma);
}

// The rotation nearest to a Jacobian: polar decomposition through the SVD.
Eigen::Quaterniond rotation_of(const Eigen::Matrix3d& jacobian) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(jacobian, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Eigen::Quaterniond(Eigen::Matrix3d(svd.matrixU() * svd.matrixV().transpose()));
}

}  // namespace

bool usable_fix(const GpsFix& f) {
  return f.status >= 0 && std::isfinite(f.time_s) && std::isfinite(f.latitude_deg) && std::isfinite(f.longitude_deg) &&
         std::isfinite(f.height_m) && std::abs(f.latitude_deg) <= 90 && std::abs(f.longitude_deg) <= 360 &&
         (f.latitude_deg != 0 || f.longitude_deg != 0);
}

GpsTrack collect_fixes(std::span<const GpsFix> fixes, const Rig& rig, double start_s, double end_s, double epoch_s,
                       const GpsOptions& options) {
  GpsTrack out;
  std::vector<GpsFix> kept;
  std::vector<double> latitude, longitude, height;
  for (GpsFix f : fixes) {
    if (!usable_fix(f)) {
      ++out.invalid;
      continue;
    }
    f.time_s += rig.gps_offset_s;
    if (f.time_s < start_s || f.time_s > end_s) continue;
    if (!kept.empty() && f.time_s <= kept.back().time_s) continue;  // repeated or out of order
    kept.push_back(f);
    latitude.push_back(f.latitude_deg), longitude.push_back(f.longitude_deg), height.push_back(f.height_m);
  }
  if (kept.empty()) return out;
  out.plane.emplace(Eigen::Vector3d(median_of(latitude), median_of(longitude), median_of(height)));
  for (const GpsFix& f : kept) {
    const double horizontal = 0.5 * (f.covariance_enu_m2(0, 0) + f.covariance_enu_m2(1, 1));
    out.positions.push_back({f.time_s - epoch_s,
                             out.plane->enu_from_geodetic({f.latitude_deg, f.longitude_deg, f.height_m}),
                             sigma_of(f, horizontal, options), sigma_of(f, f.covariance_enu_m2(2, 2), options)});
  }
  return out;
}

Trajectory map_trajectory(const PoseTrack& track, double epoch_s, const TangentPlane& plane, const MapFrame& frame) {
  Trajectory out;
  out.crs = frame.crs().code;
  out.poses.reserve(static_cast<std::size_t>(track.size()));
  Eigen::Vector3d evaluated_at = track.position.front();
  Eigen::Matrix3d jacobian = map_from_enu_jacobian(frame, plane, evaluated_at);
  Eigen::Quaterniond map_from_enu = rotation_of(jacobian);
  out.horizontal_scale = std::sqrt(std::abs(jacobian.topLeftCorner<2, 2>().determinant()));
  for (int k = 0; k < track.size(); ++k) {
    if ((track.position[k] - evaluated_at).head<2>().norm() > kFrameStep) {
      evaluated_at = track.position[k];
      jacobian = map_from_enu_jacobian(frame, plane, evaluated_at);
      map_from_enu = rotation_of(jacobian);
    }
    const Eigen::Vector3d position = frame.map_from_geodetic(plane.geodetic_from_enu(track.position[k]));
    out.poses.push_back({epoch_s + k * track.step_s, {(map_from_enu * track.rotation[k]).normalized(), position}});
  }
  return out;
}

Trajectory local_trajectory(const PoseTrack& track, double epoch_s) {
  Trajectory out;
  out.poses.reserve(static_cast<std::size_t>(track.size()));
  for (int k = 0; k < track.size(); ++k)
    out.poses.push_back({epoch_s + k * track.step_s, {track.rotation[k], track.position[k]}});
  return out;
}

}  // namespace rayfield::slam
