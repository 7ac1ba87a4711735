#include "libslam/unwarp/open_directions.h"

#include <algorithm>
#include <cmath>

namespace rayfield::slam {
namespace {

constexpr std::size_t kPerEdge = 45;  // cells along an edge of the cube: 2.5° in the middle of a face, 1.3° at its edge
constexpr std::uint32_t kEnoughBeams = 20;
constexpr std::uint32_t kBeamsPerReturn = 50;

}  // namespace

OpenDirections::OpenDirections() : cells_(6 * kPerEdge * kPerEdge) {}

std::size_t OpenDirections::cell_of(const Eigen::Vector3d& direction) {
  Eigen::Index axis = 0;
  const double largest = direction.cwiseAbs().maxCoeff(&axis);
  const auto step = [&](double tangent) {  // −1 … 1 on the face
    const double at = (tangent + 1) / 2 * static_cast<double>(kPerEdge);
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(kPerEdge) - 1));
  };
  const std::size_t face = 2 * static_cast<std::size_t>(axis) + (direction[axis] < 0 ? 1 : 0);
  const std::size_t u = step(direction[(axis + 1) % 3] / largest), v = step(direction[(axis + 2) % 3] / largest);
  return (face * kPerEdge + u) * kPerEdge + v;
}

void OpenDirections::add(const Eigen::Vector3d& direction, bool returned) {
  Cell& cell = cells_[cell_of(direction)];
  ++cell.beams, cell.returned += returned ? 1 : 0;
}

bool OpenDirections::open(const Eigen::Vector3d& direction) const {
  const Cell& cell = cells_[cell_of(direction)];
  return cell.beams >= kEnoughBeams && std::uint64_t{kBeamsPerReturn} * cell.returned >= cell.beams;
}

}  // namespace rayfield::slam
