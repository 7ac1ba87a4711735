#include "rayfield/slam/trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libslam/trajectory/so3.h"
#include "rayfield/core/map_frame.h"

namespace rayfield::slam {

bool Trajectory::at(double time_s, Rigid3& map_from_imu, std::size_t& cursor, double max_gap_s) const {
  if (poses.size() < 2 || !(time_s >= poses.front().time_s) || time_s > poses.back().time_s) return false;
  const auto later = [](double t, const TimedPose& p) { return t < p.time_s; };
  if (cursor + 1 >= poses.size() || poses[cursor].time_s > time_s || poses[cursor + 1].time_s < time_s) {
    if (cursor + 2 < poses.size() && poses[cursor + 1].time_s <= time_s && time_s <= poses[cursor + 2].time_s)
      ++cursor;
    else
      cursor = static_cast<std::size_t>(std::upper_bound(poses.begin() + 1, poses.end() - 1, time_s, later) -
                                        poses.begin() - 1);
  }
  const TimedPose &a = poses[cursor], &b = poses[cursor + 1];
  const double gap = b.time_s - a.time_s;
  if (gap > max_gap_s) return false;
  const double f = (time_s - a.time_s) / gap;
  map_from_imu.rotation = between(a.map_from_body.rotation, b.map_from_body.rotation, f);
  map_from_imu.translation = (1 - f) * a.map_from_body.translation + f * b.map_from_body.translation;
  return true;
}

double Trajectory::length_m() const {
  double sum = 0;
  for (std::size_t k = 1; k < poses.size(); ++k)
    sum += (poses[k].map_from_body.translation - poses[k - 1].map_from_body.translation).norm();
  return sum;
}

Result<Trajectory> make_trajectory(std::vector<TimedPose> poses, const std::string& crs) {
  const auto bad = [](const std::string& where, std::string_view why) {
    return fail(ErrorCode::bad_input, "cannot use trajectory", where, why);
  };
  if (poses.size() < 2) return bad("trajectory", "it holds fewer than two poses");
  for (std::size_t k = 0; k < poses.size(); ++k) {
    Rigid3& pose = poses[k].map_from_body;
    if (!std::isfinite(poses[k].time_s) || !pose.translation.allFinite() || !pose.rotation.coeffs().allFinite() ||
        pose.rotation.norm() < 0.5)
      return bad(fmt::format("pose {}", k), "a value is not finite or the rotation is not a unit quaternion");
    if (k > 0 && poses[k].time_s <= poses[k - 1].time_s)
      return bad(fmt::format("pose {}", k), "its time is not later than that of the pose before");
    pose.rotation.normalize();
  }
  Trajectory out;
  out.crs = crs;
  if (!crs.empty()) {
    RAYFIELD_ASSIGN(const MapFrame frame, MapFrame::create(crs));
    out.horizontal_scale = frame.scale_factor(poses.front().map_from_body.translation);
  }
  out.poses = std::move(poses);
  return out;
}

}  // namespace rayfield::slam
