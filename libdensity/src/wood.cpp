#include "rayfield/density/wood.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rayfield::density {

double half_surface_m2(const WoodCylinder& wood, double from_m, double to_m) {
  const double lo = std::clamp(from_m, 0.0, wood.length_m), hi = std::clamp(to_m, 0.0, wood.length_m);
  return std::numbers::pi * wood.radius_m * std::max(0.0, hi - lo);
}

std::vector<WoodCylinder> cylinders_of_posts(std::span<const Post> posts, std::span<const double> ground_m) {
  std::vector<WoodCylinder> out;
  for (std::size_t i = 0; i < posts.size() && i < ground_m.size(); ++i) {
    if (!posts[i].detected || !(posts[i].height_m > 0) || !std::isfinite(ground_m[i])) continue;
    out.push_back({posts[i].row,
                   {posts[i].position.x(), posts[i].position.y(), ground_m[i]},
                   Eigen::Vector3d::UnitZ(),
                   posts[i].radius_m,
                   posts[i].height_m});
  }
  return out;
}

bool shell_interval(const WoodCylinder& wood, double shell_m, const Eigen::Vector3d& origin,
                    const Eigen::Vector3d& direction, double& t_in, double& t_out) {
  const Eigen::Vector3d from_base = origin - wood.base;
  const double h0 = from_base.dot(wood.axis), dh = direction.dot(wood.axis);
  const Eigen::Vector3d p = from_base - h0 * wood.axis, d = direction - dh * wood.axis;
  const double radius = wood.radius_m + shell_m;
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

}  // namespace rayfield::density
