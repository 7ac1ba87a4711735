#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "libdensity/layout/row_layout.h"
#include "libdensity/voxels/wood.h"

namespace rayfield::density {

/// Map → voxel coordinates of a row segment: g = linear·(p − origin) + offset, in units of voxels; the grid is
/// [0, n_along) × [0, n_across) × [0, n_up). Affine (the terrain shear included), so that straight rays stay straight.
struct GridFrame {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  explicit GridFrame(const RowSegment& row_segment);
  Eigen::Vector3d grid_from_map(const Eigen::Vector3d& p_in_map) const { return linear * (p_in_map - origin) + offset; }
  Eigen::Vector3d map_from_grid(const Eigen::Vector3d& g) const { return linear.inverse() * (g - offset) + origin; }
};

/// Coarse index in plan: which row segments and which wood a ray can meet in each cell, and between what heights.
class VoxelIndex {
 public:
  VoxelIndex() = default;
  /// Covers the part of the row segments inside `bounds` (plan).
  VoxelIndex(std::span<const RowSegment> row_segments, std::span<const WoodCylinder> wood, double shell_m,
             const Eigen::AlignedBox2d& bounds);

  int words() const { return words_; }
  /// Sets in `mask` (words() words; bit i = row segment i, bit row segments+j = wood j) all that p + t·d, 0 ≤ t ≤
  /// length, can meet. Returns false, mask untouched, when that is nothing.
  bool candidates(const Eigen::Vector3d& p, const Eigen::Vector3d& d, double length, std::uint64_t* mask) const;

 private:
  struct Cell {
    double low, high;
  };
  void cover_row_segment(const RowSegment& row_segment, int bit);
  void cover_cylinder(const WoodCylinder& wood, double shell_m, int bit);
  void cover_cell(int ix, int iy, int bit, double low, double high);
  std::size_t at(int ix, int iy) const {
    return static_cast<std::size_t>(iy) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(ix);
  }

  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int nx_ = 0, ny_ = 0, words_ = 0;
  double low_ = 0, high_ = 0;
  std::vector<Cell> cells_;
  std::vector<std::uint64_t> masks_;
};

}  // namespace rayfield::density
