#include "libslam/gps/gps_alignment.h"

#include <algorithm>
#include <cmath>

#include "rayfield/core/median.h"

namespace rayfield::slam {
namespace {

struct Pair {
  double time_s;
  Eigen::Vector3d world, enu;
};

// Weighted least squares for yaw and translation in closed form (the planar Procrustes problem; height is a mean).
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

// One pair of fixes two seconds apart: difference of offsets and of antenna velocities, horizontal.
struct OffsetPair {
  Eigen::Vector2d offset, velocity;
};

std::vector<OffsetPair> offset_pairs(const PoseTrack& track, std::span<const GpsPosition> fixes,
                                     const Eigen::Vector3d& arm, double shift_s) {
  constexpr double kLag = 2.0, kSlack = 0.5;
  const auto antenna = [&](double t) -> Eigen::Vector2d { return (track.pose(t) * arm).head<2>(); };
  std::vector<OffsetPair> out;
  std::size_t j = 0;
  for (const GpsPosition& a : fixes) {
    while (j < fixes.size() && fixes[j].time_s < a.time_s + kLag) ++j;
    if (j == fixes.size()) break;
    const GpsPosition& b = fixes[j];
    const double ta = a.time_s + shift_s, tb = b.time_s + shift_s, h = 0.05;
    if (b.time_s > a.time_s + kLag + kSlack || ta < h || tb > track.end_s() - h) continue;
    const auto velocity = [&](double t) -> Eigen::Vector2d { return (antenna(t + h) - antenna(t - h)) / (2 * h); };
    out.push_back({(antenna(tb) - b.enu.head<2>()) - (antenna(ta) - a.enu.head<2>()), velocity(tb) - velocity(ta)});
  }
  return out;
}

}  // namespace

void transform_track(PoseTrack& track, const Rigid3& transform) {
  for (int k = 0; k < track.size(); ++k) {
    track.position[k] = transform * track.position[k];
    track.rotation[k] = (transform.rotation * track.rotation[k]).normalized();
  }
}

// Reweights the closed-form fit until jumps have lost their weight, then derives the uncertainty of the yaw from the
// residuals and the extent of the drive.
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
    out.median_residual_m = median_of(residuals, 0);
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

// Gauss-Newton with Cauchy weights on the differences described in the header; gives up where velocities hardly change.
GpsOffsetFit fit_gps_offset(const PoseTrack& track, std::span<const GpsPosition> fixes,
                            const Eigen::Vector3d& lever_arm_m) {
  constexpr double kMinInformation = 0.5;  // (m/s)², of changes of velocity: less is a straight drive
  GpsOffsetFit out;
  for (int iteration = 0; iteration < 8; ++iteration) {
    const std::vector<OffsetPair> pairs = offset_pairs(track, fixes, lever_arm_m, out.offset_s);
    std::vector<double> size;
    for (const OffsetPair& p : pairs) size.push_back(p.offset.norm());
    const double scale = 2 * std::max(median_of(std::move(size), 0), 0.02);
    double information = 0, gradient = 0, squares = 0, weights = 0;
    for (const OffsetPair& p : pairs) {
      const double w = 1 / (1 + p.offset.squaredNorm() / (scale * scale));
      information += w * p.velocity.squaredNorm();
      gradient += w * p.velocity.dot(p.offset);
      squares += w * p.offset.squaredNorm() / 2, weights += w;
    }
    if (pairs.size() < 50 || information < kMinInformation) return {};
    out.offset_s -= gradient / information;
    if (std::abs(out.offset_s) > 2) return {};
    // Pairs overlap: those within one lag of two seconds count as one.
    const double together =
        std::max(1.0, static_cast<double>(pairs.size()) * 2.0 / (fixes.back().time_s - fixes.front().time_s));
    out.sigma_s = std::sqrt(squares / weights / information * together);
  }
  out.solved = true;
  return out;
}

}  // namespace rayfield::slam
