#include "start.h"

#include <algorithm>
#include <cmath>

#include "rayfield/core/parallel.h"
#include "surfel_match.h"

namespace rayfield::slam {
namespace {

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

// Keeps every n-th so that at most `count` are left.
void thin(std::vector<PlacedSurfel>& surfels, std::size_t count) {
  const std::size_t stride = surfels.size() / count + 1;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < surfels.size(); k += stride) surfels[kept++] = surfels[k];
  surfels.resize(kept);
}

// Sum over surfels of the truncated agreement with their matches under an added velocity.
double agreement(std::span<const PlacedSurfel> base, const Eigen::Vector3f& velocity, const SlamOptions& options) {
  std::vector<PlacedSurfel> moved(base.begin(), base.end());
  for (PlacedSurfel& s : moved) s.center += velocity * s.time_s;
  MatchQuery query;
  query.radius_voxels = 0.6;
  query.normal_scale_m = options.match.normal_scale_m;
  query.min_gap_s = options.match.min_time_gap_s;
  const auto matches = mutual_matches(moved, options.surfels.voxel_size_m, query, 1);
  double score = 0;
  const double scale = 0.06;
  for (const SurfelMatch& m : matches) {
    const PlacedSurfel &a = moved[m.first], &b = moved[m.second];
    const Eigen::Vector3f n = (a.normal + b.normal).normalized();
    const double e = static_cast<double>((b.center - a.center).dot(n)) / scale;
    score += 1 / (1 + e * e);
  }
  return score;
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

Eigen::Vector3d search_velocity(std::span<const Surfel> surfels, const PoseTrack& track, const SlamOptions& options,
                                double max_speed) {
  std::vector<PlacedSurfel> placed = place_surfels(surfels, track, track.position[0], 1);
  // Level ground agrees with any horizontal velocity: only upright surfaces tell.
  std::erase_if(placed, [](const PlacedSurfel& s) { return std::abs(s.normal.z()) > 0.7f; });
  thin(placed, 3000);
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  // Coarse to fine: the basin of a vineyard's posts is a few decimetres over the two seconds between sweeps.
  double step = 0.15, reach = max_speed;
  for (int level = 0; level < 3; ++level) {
    const int n = static_cast<int>(std::ceil(reach / step));
    const std::size_t side = static_cast<std::size_t>(2 * n + 1);
    std::vector<double> score(side * side, -1);
    const auto candidate = [&](std::size_t k) {
      const double x = (static_cast<double>(k % side) - n) * step, y = (static_cast<double>(k / side) - n) * step;
      return Eigen::Vector3d(best + Eigen::Vector3d(x, y, 0));
    };
    (void)parallel_for(score.size(), thread_count(options.threads), [&](std::size_t k, int) -> Result<void> {
      const Eigen::Vector3d v = candidate(k);
      if (v.head<2>().norm() <= max_speed + step) score[k] = agreement(placed, v.cast<float>(), options);
      return {};
    });
    const std::size_t winner = static_cast<std::size_t>(std::max_element(score.begin(), score.end()) - score.begin());
    best = candidate(winner);
    reach = step, step /= 3;
  }
  return best;
}

}  // namespace rayfield::slam
