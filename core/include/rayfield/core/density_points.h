#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rayfield {

/// What a beam hit within the voxels of a row.
enum class PointKind : std::uint8_t {
  canopy,  ///< anything but known wood: leaves, and canes, wires and cordons among them
  wood     ///< a post or trunk in the layout; its hits do not count towards the density of the canopy
};

/// Hits with the density of their voxels, for point clouds: filled by libdensity, written by formats.
struct DensityPoints {
  std::vector<Eigen::Vector3d> position;  ///< map coordinates, m
  std::vector<double> time_s;             ///< Unix time
  std::vector<std::uint16_t> intensity;   ///< as reported by the lidar
  std::vector<float> density;             ///< m²/m³; NaN on wood and where too few rays crossed the voxel
  std::vector<PointKind> kind;

  std::size_t size() const { return position.size(); }
  bool empty() const { return position.empty(); }
  void clear() { position.clear(), time_s.clear(), intensity.clear(), density.clear(), kind.clear(); }
};

}  // namespace rayfield
