#include "libdensity/voxels/beam_neighbours.h"

#include <algorithm>

namespace rayfield::density {
namespace {

// Squares of the distances between unit vectors.
constexpr float kPreviousSquare = 4.4e-4F;  // 1.2°: steps of lidars with one beam are smaller
constexpr float kFarthestSquare = 0.02F;    // 8°
constexpr double kLatestS = 0.003;          // the vehicle goes a few millimetres meanwhile

}  // namespace

std::optional<std::size_t> BeamNeighbours::on_leaf_beside(const Eigen::Vector3d& direction, double time_s) const {
  if (on_leaf_ == 0) return std::nullopt;
  const Eigen::RowVector3f to = direction.cast<float>().transpose();
  std::size_t beside = last();
  float nearest = (directions_.row(static_cast<Eigen::Index>(beside)) - to).squaredNorm();
  if (nearest > kPreviousSquare) {
    Squares squares = (directions_.rowwise() - to).rowwise().squaredNorm().array();
    for (std::size_t i = next_; time_s - rays_[i].time_s >= kLatestS && i != last(); i = (i + 1) % kRays)
      squares(static_cast<Eigen::Index>(i)) = kFarthestSquare;
    nearest = squares.minCoeff();
    beside = static_cast<std::size_t>(std::find(squares.begin(), squares.end(), nearest) - squares.begin());
  }
  if (!(nearest < kFarthestSquare) || !rays_[beside].on_leaf) return std::nullopt;
  return rays_[beside].number;
}

void BeamNeighbours::add(std::size_t number, const Eigen::Vector3d& direction, double time_s, bool on_leaf) {
  on_leaf_ += std::size_t{on_leaf} - std::size_t{rays_[next_].on_leaf};
  directions_.row(static_cast<Eigen::Index>(next_)) = direction.cast<float>().transpose();
  rays_[next_] = {number, time_s, on_leaf};
  next_ = (next_ + 1) % kRays;
}

}  // namespace rayfield::density
