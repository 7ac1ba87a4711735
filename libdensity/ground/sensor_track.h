#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "libdensity/ground/survey.h"

namespace rayfield::density {

/// Where the sensor was at any time of a scan: tiles hold clipped rays, whose origins lie elsewhere.
class SensorTrack {
 public:
  SensorTrack() = default;
  /// `points`: of ScanSurvey::path(), ascending in time; linear in between, and on from the first and the last two (the
  /// points are means over time steps, so that rays begin before the first of them).
  explicit SensorTrack(std::vector<PathPoint> points) : points_(std::move(points)) {}

  bool empty() const { return points_.empty(); }
  /// m, map coordinates; (0, 0, 0) of an empty track. `hint`: where an earlier call ended, for times that come nearly
  /// in order; it changes no result.
  Eigen::Vector3d position(double time_s, std::size_t& hint) const;

 private:
  std::vector<PathPoint> points_;
};

}  // namespace rayfield::density
