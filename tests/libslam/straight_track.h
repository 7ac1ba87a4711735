#pragma once

#include "libslam/trajectory/pose_track.h"

namespace rayfield::slam::testing {

constexpr double kStep = 0.01;  // s

/// A level drive along x.
inline PoseTrack straight_track(double duration_s, double speed_m_s) {
  PoseTrack track;
  for (int k = 0; k * kStep <= duration_s; ++k) {
    track.position.push_back(Eigen::Vector3d(speed_m_s * kStep * k, 0, 0));
    track.rotation.push_back(Eigen::Quaterniond::Identity());
  }
  return track;
}

}  // namespace rayfield::slam::testing
