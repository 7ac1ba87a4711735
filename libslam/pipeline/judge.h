#pragma once

#include "libslam/global/global.h"
#include "libslam/gps/georeference.h"
#include "libslam/pipeline/drive_input.h"
#include "rayfield/slam/slam.h"

namespace rayfield::slam {

/// Everything a finished run knows.
struct RunFacts {
  const Drive& drive;
  const GpsTrack& gps;
  const GpsAlignment& alignment;
  const GlobalStats& stats;
  const Rig& rig;
  const SlamOptions& options;
  const GpsOffsetFit& gps_offset;
  Eigen::Quaterniond enu_from_world;  ///< of the windowed stage's frame
};

/// The report of a run; marks GPS outliers in `result`.
SlamReport make_report(const RunFacts& facts, SlamResult& result);

/// Whether the drive may be believed. Errors: bad_input with the reason: surfaces that do not meet themselves, a
/// trajectory that contradicts GPS, motion that no vehicle makes, windows in which hardly any surface matched.
Result<void> judge(const RunFacts& facts, const SlamReport& report);

}  // namespace rayfield::slam
