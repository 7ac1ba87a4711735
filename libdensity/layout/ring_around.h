#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace rayfield::density {

/// Ring around a line, `half_width_m` to either side: counter-clockwise and closed. Vertices closer to another than 0.1
/// m are left out but for both ends: where a curved line ends just behind a vertex, the sides would cross there.
std::vector<Eigen::Vector2d> ring_around(std::span<const Eigen::Vector2d> line, double half_width_m);

}  // namespace rayfield::density
