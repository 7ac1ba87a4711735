#include "libslam/odometry/initialization.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "rayfield/core/median.h"

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

double white_sigma(const std::vector<Eigen::Vector3d>& samples) {
  std::array<double, 3> sigma{};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> differences;
    for (std::size_t k = 0; k + 4 < samples.size(); ++k)
      differences.push_back(std::abs(samples[k][axis] - 4 * samples[k + 1][axis] + 6 * samples[k + 2][axis] -
                                     4 * samples[k + 3][axis] + samples[k + 4][axis]));
    sigma[static_cast<std::size_t>(axis)] = 1.4826 * median_of(std::move(differences), 0) / std::sqrt(70.0);
  }
  std::sort(sigma.begin(), sigma.end());
  return sigma[1];
}

}  // namespace

WhiteNoise measure_white_noise(const ImuGrid& imu) {
  const double root = std::sqrt(imu.step_s());
  return {white_sigma(imu.gyro()) * root, white_sigma(imu.accel()) * root};
}

// Goes through blocks of half a second until one shows motion; averages over those before it, if there are enough.
Initialization find_initialization(const ImuGrid& imu, int samples) {
  Initialization out;
  samples = std::min(samples, imu.size());
  int stationary_samples = 0;
  BlockMoments reference;
  for (int first = 0; first + kBlock <= imu.size() && first < 6000; first += kBlock) {
    const BlockMoments m = moments(imu, first, kBlock);
    if (first == 0) reference = m;
    // Bounds: three times a poor sensor's noise (0.01 rad/s, 0.1 m/s² per sample), the shake of a spinning head
    // included; a vehicle that rolls over soil shows several times as much.
    const bool stationary = m.gyro_deviation < 0.06 && m.accel_deviation < 0.35 && m.gyro_mean.norm() < 0.05 &&
                            (m.gyro_mean - reference.gyro_mean).norm() < 0.015 &&
                            (m.accel_mean - reference.accel_mean).norm() < 0.12;
    if (!stationary) break;
    stationary_samples = first + kBlock;
  }
  // The last stationary_samples block may hold the first moment of motion.
  if (stationary_samples > 0 && stationary_samples < imu.size() - kBlock) stationary_samples -= kBlock;
  if (stationary_samples >= 2 * kBlock) {
    const BlockMoments m = moments(imu, 0, stationary_samples);
    out.stationary_s = stationary_samples * imu.step_s();
    out.level_from_imu = Eigen::Quaterniond::FromTwoVectors(m.accel_mean, Eigen::Vector3d::UnitZ());
    out.gyro_bias = m.gyro_mean;
    out.gyro_bias_sigma = std::max(1e-4, m.gyro_deviation / std::sqrt(static_cast<double>(stationary_samples)));
    out.tilt_sigma_rad = 0.01;
  } else {
    const BlockMoments m = moments(imu, 0, samples);
    out.level_from_imu = Eigen::Quaterniond::FromTwoVectors(m.accel_mean, Eigen::Vector3d::UnitZ());
    out.tilt_sigma_rad = 0.05;
  }
  return out;
}

}  // namespace rayfield::slam
