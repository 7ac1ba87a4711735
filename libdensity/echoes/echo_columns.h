#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libdensity/tiles/rounding.h"

namespace rayfield::density {

/// An echo on a leaf.
struct LeafEcho {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();   ///< from any fixed point nearby, m
  Eigen::Vector3f direction = Eigen::Vector3f::Zero();  ///< of the beam
  float width_m = 0;                                    ///< of the beam there
  std::uint16_t intensity = 0;
};

/// Of distances that are only to leave out what is farther away.
inline constexpr float kBoxSlack = 1.001F;

/// Half the sides of the box around a piece of a beam.
Eigen::Array3f box_around_beam(const Eigen::Vector3f& direction, float half_length_m, float radius_m);

/// The echoes of one place in square columns, sorted by column and height, so that their order does not depend on that
/// in which they came.
class EchoColumns {
 public:
  explicit EchoColumns(std::span<const LeafEcho> echoes);
  std::span<const LeafEcho> echoes() const { return echoes_; }

  /// Calls visit(number of the echo), in the order of the numbers, for all in the box around `position`.
  template <class Visit>
  void for_near(const Eigen::Vector3f& position, const Eigen::Array3f& half_sides_m, Visit visit) const {
    const Eigen::Array3f low = position.array() - half_sides_m, high = position.array() + half_sides_m;
    for (int ix = column_of(low.x()); ix <= column_of(high.x()); ++ix) {
      auto column = std::lower_bound(columns_.begin(), columns_.end(), Place(ix, column_of(low.y())),
                                     [](const Column& c, const Place& at) { return c.place() < at; });
      for (; column != columns_.end() && column->ix == ix && column->iy <= column_of(high.y()); ++column) {
        const auto end = echoes_.begin() + static_cast<std::ptrdiff_t>(column->end);
        auto it = std::lower_bound(echoes_.begin() + static_cast<std::ptrdiff_t>(column->begin), end, low.z(),
                                   [](const LeafEcho& e, float z) { return e.position.z() < z; });
        for (; it != end && it->position.z() <= high.z(); ++it) visit(static_cast<std::size_t>(it - echoes_.begin()));
      }
    }
  }

 private:
  static constexpr float kSideM = 0.08F;
  using Place = std::pair<int, int>;
  struct Column {
    int ix, iy;
    std::size_t begin, end;  // numbers of its echoes
    Place place() const { return {ix, iy}; }
  };
  static int column_of(float metres) { return floor_int(static_cast<double>(metres / kSideM)); }

  std::vector<LeafEcho> echoes_;
  std::vector<Column> columns_;
};

}  // namespace rayfield::density
