#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace rayfield::slam {

/// Directions, as seen from the vehicle, in which beams return something now and then. In the others a part of the
/// vehicle stops them, which lidars report like a beam that met nothing. Cells of about 2°, on the faces of a cube.
class OpenDirections {
 public:
  OpenDirections();

  /// A beam: its unit direction in the frame of the vehicle, and whether something came back.
  void add(const Eigen::Vector3d& direction, bool returned);

  /// Whether beams in this direction are known to come out: at least 20 so far, of which one in fifty returned.
  bool open(const Eigen::Vector3d& direction) const;

 private:
  struct Cell {
    std::uint32_t beams = 0, returned = 0;
  };
  static std::size_t cell_of(const Eigen::Vector3d& direction);

  std::vector<Cell> cells_;
};

}  // namespace rayfield::slam
