#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "rayfield/sim/vineyard.h"
#include "sim/terrain/ground.h"
#include "sim/terrain/triangle_mesh.h"

namespace rayfield::sim {

/// Triangles [first, last) of a mesh.
struct TriangleRange {
  std::size_t first = 0, last = 0;
};

/// Describes the canopy of a row by its triangles. Horizontal lines across the row stand every 2 cm along it and every
/// 2 cm upwards; which triangles they meet follows from the triangles' corners seen along the row and above the ground
/// under it, exactly. Areas by height and across the row are in steps of 2 cm.
class CanopySums {
 public:
  CanopySums(const Ground& ground, int row);
  void add_leaves(const TriangleMesh& mesh);
  /// Closed surfaces: half their area counts, and two crossings are one meeting.
  void add_wood(const TriangleMesh& mesh, const TriangleRange& range);
  RowCanopy finish() const;

 private:
  /// A point by the row: chainage, to the right of it, height over the ground under it.
  using Corners = std::array<Eigen::Vector3d, 3>;
  /// Areas of a stretch of row, one-sided.
  struct Stretch {
    double from_m = 0, to_m = 0;
    double area_m2 = 0;                        ///< of the canopy
    std::vector<double> by_height, by_across;  ///< the same
    std::vector<CanopyBand> profile;           ///< of panels
  };
  struct LineSums;

  Corners corners_of(const TriangleMesh& mesh, std::size_t index) const;
  void add_area(const Corners& corners, double factor, bool is_leaf);
  void add_to(Stretch& stretch, const Eigen::Vector3d& place, double area, bool is_leaf) const;
  void add_meetings(const Corners& corners, std::vector<std::uint16_t>& meetings) const;
  std::vector<Stretch> make_stretches(double step_m) const;
  CanopyTruth edges_of(const Stretch& stretch) const;
  void add_lines(const CanopyTruth& outline, std::size_t line, LineSums& sums) const;

  const Ground& ground_;
  int row_;
  std::size_t heights_ = 0, acrosses_ = 0, lines_ = 0;
  std::vector<Stretch> panels_, metres_;
  std::vector<std::uint16_t> leaves_, wood_;  ///< per line, upwards and then along: leaves, crossings of wood
};

}  // namespace rayfield::sim
