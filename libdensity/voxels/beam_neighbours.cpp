#include "libdensity/voxels/beam_neighbours.h"

#include <algorithm>

namespace rayfield::density {
namespace {

// Squares of the distances between unit vectors.
constexpr float kPreviousSquare = 4.4e-4F;  // 1.2°: steps of lidars with one beam are smaller
// No mirror turns faster (320 Hz; surveying lidars' up to 250). From one of several beams to the next, 0.2 to 2° and 0
// to 3 µs away, it is mostly more than 10 000.
constexpr double kFastestTurn = 2000;     // rad/s
constexpr float kFarthestSquare = 0.02F;  // 8°
constexpr double kLatestS = 0.003;        // the vehicle goes a few millimetres meanwhile

}  // namespace

std::optional<BeamNeighbours::Beside> BeamNeighbours::on_leaf_beside(const Eigen::Vector3d& direction,
                                                                     double time_s) const {
  if (on_leaf_ == 0) return std::nullopt;
  const Eigen::RowVector3f to = direction.cast<float>().transpose();
  const std::size_t previous = last();
  std::size_t beside = previous;
  float nearest = (directions_.row(static_cast<Eigen::Index>(beside)) - to).squaredNorm();
  const double turned = kFastestTurn * (time_s - rays_[previous].time_s);
  const bool one_beam = turned > 0 && static_cast<double>(nearest) <= turned * turned;
  if (!one_beam || nearest > kPreviousSquare) {
    Squares squares = (directions_.rowwise() - to).rowwise().squaredNorm().array();
    for (std::size_t i = next_; time_s - rays_[i].time_s >= kLatestS && i != previous; i = (i + 1) % kRays)
      squares(static_cast<Eigen::Index>(i)) = kFarthestSquare;
    nearest = squares.minCoeff();
    beside = static_cast<std::size_t>(std::find(squares.begin(), squares.end(), nearest) - squares.begin());
  }
  if (!(nearest < kFarthestSquare) || !rays_[beside].on_leaf) return std::nullopt;
  return Beside{rays_[beside].number, one_beam && beside == previous};
}

void BeamNeighbours::add(std::size_t number, const Eigen::Vector3d& direction, double time_s, bool on_leaf) {
  on_leaf_ += std::size_t{on_leaf} - std::size_t{rays_[next_].on_leaf};
  directions_.row(static_cast<Eigen::Index>(next_)) = direction.cast<float>().transpose();
  rays_[next_] = {number, time_s, on_leaf};
  next_ = (next_ + 1) % kRays;
}

}  // namespace rayfield::density
