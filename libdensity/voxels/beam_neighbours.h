#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace rayfield::density {

/// Which ray went beside another one, of a scan's rays in the order of time. Of one beam that turns it is the previous
/// one. Where that went more than 1.2° away, or less far but at once, as lidars go from beam to beam that send several
/// at a time, it is the nearest in direction among the last 128 rays of 3 ms, whatever it met: the nearest of those
/// that hit would be one between which and the ray others went past, and make leaves look small.
class BeamNeighbours {
 public:
  struct Beside {
    std::size_t number = 0;
    bool same_beam = false;  ///< that beam turned from one to the other
    bool operator==(const Beside&) const = default;
  };
  /// The ray beside one of this direction (unit vector), if that was on a leaf and is less than 8° away.
  std::optional<Beside> on_leaf_beside(const Eigen::Vector3d& direction, double time_s) const;
  /// The next ray; its number, as on_leaf_beside() gives it.
  void add(std::size_t number, const Eigen::Vector3d& direction, double time_s, bool on_leaf);

 private:
  static constexpr std::size_t kRays = 128;
  struct Ray {
    std::size_t number = 0;
    double time_s = 0;
    bool on_leaf = false;
  };
  using Squares = Eigen::Array<float, kRays, 1>;
  std::size_t last() const { return (next_ + kRays - 1) % kRays; }

  Eigen::Matrix<float, kRays, 3> directions_ = Eigen::Matrix<float, kRays, 3>::Zero();  // in a ring, as rays_
  std::vector<Ray> rays_ = std::vector<Ray>(kRays);
  std::size_t on_leaf_ = 0;  // of them
  std::size_t next_ = 0;
};

}  // namespace rayfield::density
