#include "formats/las/sensor_positions.h"

#include <algorithm>

namespace rayfield::formats {

SensorPositions::SensorPositions(std::shared_ptr<const TrajectoryFile> trajectory, const Eigen::Vector3d& lever_arm_m,
                                 double max_gap_s, double tolerance_s)
    : trajectory_(std::move(trajectory)), lever_arm_m_(lever_arm_m), max_gap_s_(max_gap_s), tolerance_s_(tolerance_s) {}

SensorPositions::Place SensorPositions::at(double time_s, Eigen::Vector3d& p_in_map) {
  const std::vector<TimedPose>& poses = trajectory_->poses;
  const double first_s = poses.front().time_s, last_s = poses.back().time_s;
  if (!(time_s >= first_s - tolerance_s_ && time_s <= last_s + tolerance_s_)) return Place::outside;
  if (time_s <= first_s || time_s >= last_s) {
    p_in_map = (time_s <= first_s ? poses.front() : poses.back()).map_from_body * lever_arm_m_;
    return Place::found;
  }
  const auto holds = [&](std::size_t k) {
    return k + 1 < poses.size() && poses[k].time_s <= time_s && time_s < poses[k + 1].time_s;
  };
  if (!holds(cursor_)) {
    const auto later = [](double t, const TimedPose& pose) { return t < pose.time_s; };
    if (holds(cursor_ + 1))
      ++cursor_;
    else
      cursor_ =
          static_cast<std::size_t>(std::upper_bound(poses.begin(), poses.end(), time_s, later) - poses.begin() - 1);
  }
  const TimedPose &a = poses[cursor_], &b = poses[cursor_ + 1];
  const double gap_s = b.time_s - a.time_s;
  if (gap_s > max_gap_s_) {
    const bool at_a = time_s - a.time_s <= tolerance_s_, at_b = b.time_s - time_s <= tolerance_s_;
    if (!at_a && !at_b) return Place::gap;
    p_in_map = (at_a ? a : b).map_from_body * lever_arm_m_;
    return Place::found;
  }
  const double f = (time_s - a.time_s) / gap_s;
  p_in_map = (1 - f) * a.map_from_body.translation + f * b.map_from_body.translation;
  if (!lever_arm_m_.isZero(0)) p_in_map += a.map_from_body.rotation.slerp(f, b.map_from_body.rotation) * lever_arm_m_;
  return Place::found;
}

}  // namespace rayfield::formats
