#include "libdensity/layout/ring_around.h"

#include <algorithm>

namespace rayfield::density {

std::vector<Eigen::Vector2d> ring_around(std::span<const Eigen::Vector2d> line, double half_width_m) {
  constexpr double kShortest_m = 0.1;
  std::vector<Eigen::Vector2d> kept;
  for (const Eigen::Vector2d& p : line)
    if (kept.empty() || (p - kept.back()).norm() >= kShortest_m) kept.push_back(p);
  if (!line.empty() && kept.size() > 1) kept.back() = line.back();
  if (!line.empty() && kept.size() == 1) kept.push_back(line.back());
  std::vector<Eigen::Vector2d> ring;
  const auto side = [&](std::size_t i, double across) {
    const Eigen::Vector2d along = (kept[std::min(i + 1, kept.size() - 1)] - kept[i > 0 ? i - 1 : 0]).normalized();
    ring.emplace_back(kept[i] + across * Eigen::Vector2d(-along.y(), along.x()));
  };
  for (std::size_t i = 0; i < kept.size(); ++i) side(i, -half_width_m);
  for (std::size_t i = kept.size(); i-- > 0;) side(i, half_width_m);
  if (!ring.empty()) ring.push_back(ring.front());
  return ring;
}

}  // namespace rayfield::density
