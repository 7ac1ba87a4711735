#pragma once

#include <Eigen/Geometry>

#include "libslam/global_registration/global_registration.h"
#include "libslam/gps/georeference.h"
#include "libslam/gps/gps_alignment.h"
#include "libslam/pipeline/log_odometry.h"
#include "rayfield/core/rig.h"
#include "rayfield/slam/options.h"

namespace rayfield::slam {

/// What is known at the end of a run.
struct RunFacts {
  const LogSection& section;
  const GpsTrack& gps;
  const GpsAlignment& alignment;
  const RegistrationStats& stats;
  const Rig& rig;
  const SlamOptions& options;
  const GpsOffsetFit& gps_offset;
  Eigen::Quaterniond enu_from_world;  ///< of the frame of stage a
};

}  // namespace rayfield::slam
