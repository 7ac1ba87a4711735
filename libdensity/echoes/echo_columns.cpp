#include "libdensity/echoes/echo_columns.h"

#include <tuple>

namespace rayfield::density {
namespace {

struct PlacedEcho {
  int ix, iy;
  const LeafEcho* echo;
  auto key() const {
    return std::tuple(ix, iy, echo->position.z(), echo->position.x(), echo->position.y(), echo->intensity,
                      echo->direction.x(), echo->direction.y());
  }
};

}  // namespace

Eigen::Array3f box_around_beam(const Eigen::Vector3f& direction, float half_length_m, float radius_m) {
  const Eigen::Array3f along = direction.array().abs(), across = (1 - along.square()).max(0).sqrt();
  return kBoxSlack * (half_length_m * along + radius_m * across);
}

EchoColumns::EchoColumns(std::span<const LeafEcho> echoes) {
  std::vector<PlacedEcho> placed;
  placed.reserve(echoes.size());
  for (const LeafEcho& e : echoes) placed.push_back({column_of(e.position.x()), column_of(e.position.y()), &e});
  std::sort(placed.begin(), placed.end(), [](const PlacedEcho& a, const PlacedEcho& b) { return a.key() < b.key(); });
  echoes_.reserve(echoes.size());
  for (const PlacedEcho& p : placed) {
    if (columns_.empty() || columns_.back().place() != Place(p.ix, p.iy))
      columns_.push_back({p.ix, p.iy, echoes_.size(), 0});
    echoes_.push_back(*p.echo), columns_.back().end = echoes_.size();
  }
}

}  // namespace rayfield::density
