#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "libslam/surfels/surfel_file.h"

namespace rayfield::slam::testing {

/// A drive back and forth over a field of 150 × 90 m that is not level, with surfels up to 20 m away.
struct Field {
  PoseTrack track;
  std::vector<Surfel> surfels;
  SurfelFile file;

  explicit Field(int count) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<float> side(-20, 20), up(-1, 1), unit(0, 1);
    for (int k = 0; k < 60000; ++k) {
      const double t = 0.01 * k, along = 150 * (0.5 - 0.5 * std::cos(t / 40));
      track.position.push_back(Eigen::Vector3d(along - 60, 0.15 * t - 40, 0.02 * along));
      track.rotation.push_back(exp_so3(Eigen::Vector3d(0.02, 0.01 * std::sin(t), 0.6 + 0.1 * std::sin(t / 7))));
    }
    for (int k = 0; k < count; ++k) {
      Surfel s;
      s.time_s = track.end_s() * (k + 0.5) / count;
      s.center = Eigen::Vector3f(side(generator), side(generator), up(generator));
      s.normal = Eigen::Vector3f(up(generator), up(generator), 3).normalized();
      s.variance_m2 = 1e-5f * unit(generator);
      s.spin_rate_rad_s = 3;
      s.level = static_cast<std::uint8_t>(k % 3);
      surfels.push_back(s);
    }
    for (std::size_t at = 0; at < surfels.size(); at += 777)
      EXPECT_TRUE(file.append(std::span(surfels).subspan(at, std::min<std::size_t>(777, surfels.size() - at))));
  }
};

}  // namespace rayfield::slam::testing
