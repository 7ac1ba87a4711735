#include "libdensity/voxels/wood.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rayfield::density {
namespace {

// Vines are never straight. What of a trunk stands out of a straight shell reads, as a solid in a voxel, as far more
// leaves than it is: 1–2 % of the plant area at budburst for trunks that sway by 2.5 cm.
constexpr double kTrunkBend = 0.02;  // m

}  // namespace

std::vector<WoodCylinder> wood_of(const RowLayout& layout, const GroundModel& ground) {
  std::vector<WoodCylinder> wood;
  const auto stand = [&](int row, const Eigen::Vector2d& position, const Eigen::Vector2d& lean, double radius_m,
                         double top_m, double bend_m) {
    const std::optional<double> height = ground.height(position.x(), position.y());
    if (!height || radius_m <= 0 || top_m <= 0) return;
    const Eigen::Vector3d axis(lean.x(), lean.y(), 1);
    wood.push_back(
        {row, {position.x(), position.y(), *height}, axis.normalized(), radius_m, top_m * axis.norm(), bend_m});
  };
  for (const Post& post : layout.posts)
    if (post.detected) stand(post.row, post.position, post.lean, post.radius_m, post.height_m, 0);
  for (const Trunk& trunk : layout.trunks)
    stand(trunk.row, trunk.position, Eigen::Vector2d::Zero(), trunk.radius_m, trunk.top_m, kTrunkBend);
  return wood;
}

double distance_from_axis(const WoodCylinder& wood, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d across = wood.axis.cross(direction), from_base = origin - wood.base;
  const double norm = across.norm();
  return norm > 1e-9 * direction.norm() ? std::abs(from_base.dot(across)) / norm : wood.axis.cross(from_base).norm();
}

bool shell_interval(const WoodCylinder& wood, double shell_m, const Eigen::Vector3d& origin,
                    const Eigen::Vector3d& direction, double& t_in, double& t_out) {
  const Eigen::Vector3d from_base = origin - wood.base;
  const double h0 = from_base.dot(wood.axis), dh = direction.dot(wood.axis);
  const Eigen::Vector3d p = from_base - h0 * wood.axis, d = direction - dh * wood.axis;
  const double radius = wood.radius_m + wood.bend_m + shell_m;
  const double a = d.squaredNorm(), b = p.dot(d), c = p.squaredNorm() - radius * radius;
  t_in = -std::numeric_limits<double>::infinity();
  t_out = std::numeric_limits<double>::infinity();
  if (a > 1e-18 * direction.squaredNorm()) {
    const double disc = b * b - a * c;
    if (disc <= 0) return false;
    const double root = std::sqrt(disc);
    t_in = (-b - root) / a, t_out = (-b + root) / a;
  } else if (c >= 0) {
    return false;
  }
  const double top = wood.length_m + shell_m;
  if (dh > 0)
    t_out = std::min(t_out, (top - h0) / dh);
  else if (dh < 0)
    t_in = std::max(t_in, (top - h0) / dh);
  else if (h0 >= top)
    return false;
  return t_in < t_out;
}

bool in_shell(const WoodCylinder& wood, double shell_m, const Eigen::Vector3d& p_in_map) {
  const Eigen::Vector3d from_base = p_in_map - wood.base;
  const double along = from_base.dot(wood.axis), radius = wood.radius_m + wood.bend_m + shell_m;
  return along < wood.length_m + shell_m && (from_base - along * wood.axis).squaredNorm() < radius * radius;
}

}  // namespace rayfield::density
