#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rayfield {

/// What a beam hit within the voxels of a row.
enum class PointKind : std::uint8_t {
  canopy,  ///< anything but known wood: leaves, and canes, wires and cordons among them
  wood     ///< a post or a trunk that the layout knows; its hits are no part of the canopy's density
};

/// Hits with the density of their voxels, for point clouds: filled by libdensity, written by formats.
struct DensityPoints {
  std::vector<Eigen::Vector3d> position;  ///< map coordinates, m
  std::vector<double> time_s;             ///< Unix time
  std::vector<std::uint16_t> intensity;   ///< as the lidar gives it
  std::vector<float> density;             ///< m²/m³; NaN on wood, and where too few rays crossed the voxel to tell
  std::vector<PointKind> kind;

  std::size_t size() const { return position.size(); }
  bool empty() const { return position.empty(); }
  void clear() { position.clear(), time_s.clear(), intensity.clear(), density.clear(), kind.clear(); }
};

}  // namespace rayfield
