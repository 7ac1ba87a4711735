#include "start.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr double kSearchSpan = 3.5;  // s of points in the search for the initial velocity
constexpr int kBlock = 50;  // samples of a test block: half a second

struct BlockMoments {
  Eigen::Vector3d gyro_mean = Eigen::Vector3d::Zero(), accel_mean = Eigen::Vector3d::Zero();
  double gyro_deviation = 0, accel_deviation = 0;
};

BlockMoments moments(const ImuGrid& imu, int first, int count) {
  BlockMoments m;
  for (int k = first; k < first + count; ++k)
    m.gyro_mean += imu.gyro()[k] / count, m.accel_mean += imu.accel()[k] / count;
  for (int k = first; k < first + count; ++k) {
    m.gyro_deviation += (imu.gyro()[k] - m.gyro_mean).squaredNorm() / count;
    m.accel_deviation += (imu.accel()[k] - m.accel_mean).squaredNorm() / count;
  }
  m.gyro_deviation = std::sqrt(m.gyro_deviation), m.accel_deviation = std::sqrt(m.accel_deviation);
  return m;
}

struct TimedPoint {
  Eigen::Vector3f position;  // under zero initial velocity
  float time_s;
};

std::uint64_t cell_key(const Eigen::Vector3f& p, float cell_m) {
  const auto part = [&](float v) {
    return static_cast<std::uint64_t>(static_cast<int>(std::floor(v / cell_m)) + (1 << 20)) & 0x1fffff;
  };
  return (part(p.x()) << 42) | (part(p.y()) << 21) | part(p.z());
}

// Points more than 0.4 m above the lowest one within their 2 m cell: level ground agrees with any velocity.
std::vector<TimedPoint> above_ground(const std::vector<TimedPoint>& points) {
  const auto column = [](const TimedPoint& p) { return cell_key({p.position.x(), p.position.y(), 0}, 2.0f); };
  std::map<std::uint64_t, float> lowest;
  for (const TimedPoint& p : points) {
    const auto [it, fresh] = lowest.try_emplace(column(p), p.position.z());
    if (!fresh) it->second = std::min(it->second, p.position.z());
  }
  std::vector<TimedPoint> out;
  for (const TimedPoint& p : points)
    if (p.position.z() > lowest[column(p)] + 0.4f) out.push_back(p);
  return out;
}

// Share of the late points that fall into a cell which an early one has touched.
double agreement(std::span<const TimedPoint> early, std::span<const TimedPoint> late, const Eigen::Vector3f& velocity,
                 float cell_m) {
  std::vector<std::uint64_t> touched;
  touched.reserve(early.size());
  for (const TimedPoint& p : early) touched.push_back(cell_key(p.position + velocity * p.time_s, cell_m));
  std::sort(touched.begin(), touched.end());
  std::size_t met = 0;
  for (const TimedPoint& p : late)
    met += std::binary_search(touched.begin(), touched.end(), cell_key(p.position + velocity * p.time_s, cell_m));
  return static_cast<double>(met) / static_cast<double>(std::max<std::size_t>(1, late.size()));
}

}  // namespace

StartGuess guess_start(const ImuGrid& imu, int samples) {
  StartGuess out;
  samples = std::min(samples, imu.size());
  int quiet = 0;
  BlockMoments reference;
  for (int first = 0; first + kBlock <= imu.size() && first < 6000; first += kBlock) {
    const BlockMoments m = moments(imu, first, kBlock);
    if (first == 0) reference = m;
    // Bounds: three times a poor sensor's noise (0.01 rad/s, 0.1 m/s² per sample), the shake of a spinning head
    // included; a vehicle that rolls over soil shows several times as much.
    const bool still = m.gyro_deviation < 0.06 && m.accel_deviation < 0.35 && m.gyro_mean.norm() < 0.05 &&
                       (m.gyro_mean - reference.gyro_mean).norm() < 0.015 &&
                       (m.accel_mean - reference.accel_mean).norm() < 0.12;
    if (!still) break;
    quiet = first + kBlock;
  }
  // The last quiet block may hold the first moment of motion.
  if (quiet > 0 && quiet < imu.size() - kBlock) quiet -= kBlock;
  if (quiet >= 2 * kBlock) {
    const BlockMoments m = moments(imu, 0, quiet);
    out.stationary_s = quiet * imu.step_s();
    out.level_from_imu = Eigen::Quaterniond::FromTwoVectors(m.accel_mean, Eigen::Vector3d::UnitZ());
    out.gyro_bias = m.gyro_mean;
    out.gyro_bias_sigma = std::max(1e-4, m.gyro_deviation / std::sqrt(static_cast<double>(quiet)));
    out.tilt_sigma_rad = 0.01;
  } else {
    const BlockMoments m = moments(imu, 0, samples);
    out.level_from_imu = Eigen::Quaterniond::FromTwoVectors(m.accel_mean, Eigen::Vector3d::UnitZ());
    out.tilt_sigma_rad = 0.05;
  }
  return out;
}

Eigen::Vector3d search_velocity(std::span<const BodyPoint> points, const PoseTrack& track, double max_speed,
                                int threads) {
  std::vector<TimedPoint> all;
  for (const BodyPoint& p : points)
    if (p.time_s < kSearchSpan && p.position.squaredNorm() < 15.0f * 15.0f)
      all.push_back({(track.pose(p.time_s) * p.position.cast<double>()).cast<float>(), static_cast<float>(p.time_s)});
  all = above_ground(all);
  std::vector<TimedPoint> early, late;
  const std::size_t stride = all.size() / 8000 + 1;
  for (std::size_t k = 0; k < all.size(); k += stride) {
    if (all[k].time_s < 1.5f) early.push_back(all[k]);
    if (all[k].time_s >= 2.0f) late.push_back(all[k]);
  }
  // The vehicle climbs with the slope it stands on: velocities lie in the plane of its floor, headed by the first pose.
  Eigen::Vector3d floor_normal = Eigen::Vector3d::Zero();
  for (const Eigen::Quaterniond& q : track.rotation) floor_normal += q * Eigen::Vector3d::UnitZ();
  const Eigen::Quaterniond floor = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), floor_normal);
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  double step = 0.15, reach = max_speed;
  // Coarse to fine: a cell is as wide as a step moves a point over two seconds.
  for (const float cell_m : {0.3f, 0.2f, 0.12f}) {
    const int n = static_cast<int>(std::ceil(reach / step));
    const std::size_t side = static_cast<std::size_t>(2 * n + 1);
    std::vector<double> score(side * side, -1);
    const auto candidate = [&](std::size_t k) {
      const double x = (static_cast<double>(k % side) - n) * step, y = (static_cast<double>(k / side) - n) * step;
      return Eigen::Vector3d(best + Eigen::Vector3d(x, y, 0));
    };
    (void)parallel_for(score.size(), threads, [&](std::size_t k, int) -> Result<void> {
      const Eigen::Vector3d v = candidate(k);
      if (v.norm() <= max_speed + step) score[k] = agreement(early, late, (floor * v).cast<float>(), cell_m);
      return {};
    });
    best = candidate(static_cast<std::size_t>(std::max_element(score.begin(), score.end()) - score.begin()));
    reach = 2 * step, step /= 3;
  }
  return floor * best;
}

}  // namespace rayfield::slam
