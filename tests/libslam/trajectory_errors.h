#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "rayfield/core/rigid3.h"

namespace rayfield::slam::testing {

/// Errors of a trajectory against a true one in the same map frame.
struct TrajectoryErrors {
  double ate_rms_m = 0, ate_max_m = 0;  ///< after the best yaw and translation
  double drift_percent = 0;             ///< relative pose over 10 m of path, mean
  double georeferenced_rms_m = 0;       ///< as it stands
};

inline Rigid3 pose_at(std::span<const TimedPose> poses, double time_s) {
  auto next = std::lower_bound(poses.begin() + 1, poses.end() - 1, time_s,
                               [](const TimedPose& p, double t) { return p.time_s < t; });
  const TimedPose &a = *(next - 1), &b = *next;
  const double f = std::clamp((time_s - a.time_s) / (b.time_s - a.time_s), 0.0, 1.0);
  return {a.map_from_body.rotation.slerp(f, b.map_from_body.rotation),
          (1 - f) * a.map_from_body.translation + f * b.map_from_body.translation};
}

inline TrajectoryErrors trajectory_errors(std::span<const TimedPose> estimate, std::span<const TimedPose> truth) {
  std::vector<Rigid3> a, b;
  for (std::size_t k = 0; k < estimate.size(); k += 5) {
    const double t = estimate[k].time_s;
    if (t < truth.front().time_s || t > truth.back().time_s) continue;
    a.push_back(estimate[k].map_from_body), b.push_back(pose_at(truth, t));
  }
  const double n = static_cast<double>(a.size());
  Eigen::Vector3d ca = Eigen::Vector3d::Zero(), cb = ca;
  for (std::size_t k = 0; k < a.size(); ++k) ca += a[k].translation / n, cb += b[k].translation / n;
  double c = 0, s = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const Eigen::Vector3d x = a[k].translation - ca, y = b[k].translation - cb;
    c += x.head<2>().dot(y.head<2>()), s += x.x() * y.y() - x.y() * y.x();
  }
  const Eigen::Quaterniond yaw(Eigen::AngleAxisd(std::atan2(s, c), Eigen::Vector3d::UnitZ()));
  TrajectoryErrors out;
  std::vector<double> path(a.size(), 0.0);
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double e = (yaw * (a[k].translation - ca) - (b[k].translation - cb)).norm();
    out.ate_rms_m += e * e / n;
    out.ate_max_m = std::max(out.ate_max_m, e);
    out.georeferenced_rms_m += (a[k].translation - b[k].translation).squaredNorm() / n;
    if (k > 0) path[k] = path[k - 1] + (b[k].translation - b[k - 1].translation).norm();
  }
  out.ate_rms_m = std::sqrt(out.ate_rms_m), out.georeferenced_rms_m = std::sqrt(out.georeferenced_rms_m);
  int spans = 0;
  for (std::size_t k = 0, j = 0; k < a.size(); k += 10) {
    while (j < a.size() && path[j] < path[k] + 10) ++j;
    if (j == a.size()) break;
    const Eigen::Vector3d da = (a[k].inverse() * a[j]).translation, db = (b[k].inverse() * b[j]).translation;
    out.drift_percent += 100 * (da - db).norm() / 10;
    ++spans;
  }
  out.drift_percent /= std::max(1, spans);
  return out;
}

}  // namespace rayfield::slam::testing
