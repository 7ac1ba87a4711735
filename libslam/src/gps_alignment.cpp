#include "gps_alignment.h"

#include <algorithm>
#include <cmath>

namespace rayfield::slam {
namespace {

struct Pair {
  double time_s;
  Eigen::Vector3d world, enu;
};

// Weighted least squares for yaw and translation: closed form (the planar Procrustes problem; height is a mean).
Rigid3 fit(const std::vector<Pair>& pairs, const std::vector<double>& weights) {
  double sum = 0;
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < pairs.size(); ++k)
    sum += weights[k], a += weights[k] * pairs[k].world, b += weights[k] * pairs[k].enu;
  a /= sum, b /= sum;
  double cosine = 0, sine = 0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Eigen::Vector3d x = pairs[k].world - a, y = pairs[k].enu - b;
    cosine += weights[k] * (x.x() * y.x() + x.y() * y.y());
    sine += weights[k] * (x.x() * y.y() - x.y() * y.x());
  }
  Rigid3 h;
  h.rotation = Eigen::AngleAxisd(std::atan2(sine, cosine), Eigen::Vector3d::UnitZ());
  h.translation = b - h.rotation * a;
  return h;
}

}  // namespace

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void transform_track(PoseTrack& track, const Rigid3& transform) {
  for (int k = 0; k < track.size(); ++k) {
    track.position[k] = transform * track.position[k];
    track.rotation[k] = (transform.rotation * track.rotation[k]).normalized();
  }
}

GpsAlignment align_to_gps(const PoseTrack& track, std::span<const GpsPosition> fixes,
                          const Eigen::Vector3d& lever_arm_m, const GpsOptions& options) {
  GpsAlignment out;
  std::vector<Pair> pairs;
  for (const GpsPosition& fix : fixes)
    if (fix.time_s >= 0 && fix.time_s <= track.end_s())
      pairs.push_back({fix.time_s, track.pose(fix.time_s) * lever_arm_m, fix.enu});
  if (static_cast<int>(pairs.size()) < options.min_fixes) return out;

  std::vector<double> weights(pairs.size(), 1.0), residuals(pairs.size());
  for (int iteration = 0; iteration < 30; ++iteration) {
    out.enu_from_world = fit(pairs, weights);
    for (std::size_t k = 0; k < pairs.size(); ++k)
      residuals[k] = (out.enu_from_world * pairs[k].world - pairs[k].enu).head<2>().norm();
    out.median_residual_m = median_of(residuals);
    const double scale = 1.5 * std::max(out.median_residual_m, options.min_sigma_m);
    for (std::size_t k = 0; k < pairs.size(); ++k) weights[k] = 1 / (1 + residuals[k] * residuals[k] / (scale * scale));
  }
  Eigen::Vector2d low = pairs.front().world.head<2>(), high = low, mean = Eigen::Vector2d::Zero();
  for (const Pair& p : pairs) {
    low = low.cwiseMin(p.world.head<2>()), high = high.cwiseMax(p.world.head<2>());
    mean += p.world.head<2>() / static_cast<double>(pairs.size());
  }
  out.baseline_m = (high - low).norm();
  double spread = 0;
  for (const Pair& p : pairs) spread += (p.world.head<2>() - mean).squaredNorm();
  const double duration = pairs.back().time_s - pairs.front().time_s;
  const double independent = std::max(2.0, duration / std::max(options.correlation_time_s, 1e-3));
  const double rms_spread = std::sqrt(spread / static_cast<double>(pairs.size()));
  out.yaw_sigma_rad = out.median_residual_m / std::max(rms_spread, 1e-3) / std::sqrt(independent);
  out.solved = out.baseline_m >= options.min_baseline_m;
  return out;
}

}  // namespace rayfield::slam
