#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "libslam/surfels/surfel.h"

namespace rayfield::slam::testing {

/// Two lanes on either side of a row of trunks, driven in opposite directions; every fifth of a second each trunk
/// nearer than three metres shows one scan line, anywhere on it.
struct Row {
  std::vector<double> radius_m;  // a trunk every 1.5 m, from x = 3 on
  PoseTrack track;
  std::vector<Surfel> detections;
  double trunk_x(std::size_t k) const { return 3 + 1.5 * static_cast<double>(k); }
};

inline Row drive_along(const std::vector<double>& radius_m, double across_error_m) {
  Row row;
  row.radius_m = radius_m;
  const double length = 6 + 1.5 * static_cast<double>(radius_m.size()), turn_s = 15;  // at 1 m/s
  PoseTrack truth;
  for (int k = 0; 0.01 * k <= 2 * length + turn_s; ++k) {
    const double t = 0.01 * k, f = std::clamp((t - length) / turn_s, 0.0, 1.0), turned = f * f * (3 - 2 * f);
    const double x = std::min(t, length) - std::max(0.0, t - length - turn_s);
    truth.position.emplace_back(x, 1.4 * (2 * turned - 1), 1.6);
    truth.rotation.emplace_back(Eigen::AngleAxisd(std::numbers::pi * turned, Eigen::Vector3d::UnitZ()));
    row.track.position.push_back(truth.position.back() + Eigen::Vector3d(0, turned * across_error_m, 0));
  }
  row.track.rotation = truth.rotation;
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  std::normal_distribution<double> noise(0, 0.004);
  for (double t = 0; t < truth.end_s(); t += 0.2)
    for (std::size_t k = 0; k < radius_m.size(); ++k) {
      const Rigid3 pose = truth.pose(t);
      const Eigen::Vector3d axis(row.trunk_x(k), 0, 0.5), to = axis - pose.translation;
      if (to.head<2>().norm() > 3) continue;
      const Eigen::Vector3d view = Eigen::Vector3d(to.x(), to.y(), 0).normalized(), side(-view.y(), view.x(), 0);
      const double u = anywhere(generator), r = radius_m[k];
      const Eigen::Vector3d hit = axis + u * r * side - (std::sqrt(1 - u * u) * r + noise(generator)) * view;
      Surfel s;
      s.time_s = t;
      s.center = (pose.inverse() * hit).cast<float>();
      s.normal = (pose.rotation.conjugate() * Eigen::Vector3d(-view)).cast<float>();
      row.detections.push_back(s);
    }
  return row;
}

}  // namespace rayfield::slam::testing
