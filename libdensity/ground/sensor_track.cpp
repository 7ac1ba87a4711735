#include "libdensity/ground/sensor_track.h"

#include <algorithm>

namespace rayfield::density {

Eigen::Vector3d SensorTrack::position(double time_s, std::size_t& hint) const {
  if (points_.empty()) return Eigen::Vector3d::Zero();
  if (points_.size() == 1) return points_.front().position;
  // Between points_[at] and points_[at + 1].
  const std::size_t last = points_.size() - 2;
  std::size_t at = std::min(hint, last);
  const bool here = points_[at].time_s <= time_s && time_s < points_[at + 1].time_s;
  if (!here) {
    const auto after = std::upper_bound(points_.begin(), points_.end(), time_s,
                                        [](double time, const PathPoint& point) { return time < point.time_s; });
    const auto index = after - points_.begin();
    at = index == 0 ? 0 : std::min(static_cast<std::size_t>(index - 1), last);
  }
  hint = at;
  const PathPoint &a = points_[at], &b = points_[at + 1];
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
  // Where the drive paused, points of one place are far apart in time; no more than a step is drawn out.
  return a.position + std::clamp(share, -1.0, 2.0) * (b.position - a.position);
}

}  // namespace rayfield::density
