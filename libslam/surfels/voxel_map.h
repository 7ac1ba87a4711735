#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace rayfield::slam {

/// Sums over the points of a voxel, relative to an origin near them.
struct VoxelSums {
  int x = 0, y = 0, z = 0;
  int count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::array<double, 6> products{};  // xx, xy, xz, yy, yz, zz
  double time_sum = 0, spin_sum = 0;

  Eigen::Vector3d mean() const { return sum / count; }
  Eigen::Matrix3d covariance() const {
    const auto& q = products;
    Eigen::Matrix3d c;
    c << q[0], q[1], q[2], q[1], q[3], q[4], q[2], q[4], q[5];
    return c / count - mean() * mean().transpose();
  }
};

inline std::uint64_t mix_bits(std::uint64_t h) {
  h ^= h >> 33, h *= 0xff51afd7ed558ccdULL, h ^= h >> 33, h *= 0xc4ceb9fe1a85ec53ULL, h ^= h >> 33;
  return h;
}

inline std::uint64_t voxel_hash(int x, int y, int z) {
  return mix_bits(static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) * 73856093u ^
                  static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) * 19349663u ^
                  static_cast<std::uint64_t>(static_cast<std::uint32_t>(z)) * 83492791u);
}

/// A hash map of voxels with open addressing. Voxels are in the order in which points first fell into them.
class VoxelMap {
 public:
  explicit VoxelMap(std::size_t expected) {
    std::size_t capacity = 64;
    while (capacity < 2 * expected) capacity *= 2;
    slots_.assign(capacity, -1);
  }
  VoxelSums& at(int x, int y, int z) {
    if (2 * (voxels_.size() + 1) > slots_.size()) grow();
    std::size_t s = voxel_hash(x, y, z) & (slots_.size() - 1);
    while (slots_[s] >= 0) {
      VoxelSums& c = voxels_[static_cast<std::size_t>(slots_[s])];
      if (c.x == x && c.y == y && c.z == z) return c;
      s = (s + 1) & (slots_.size() - 1);
    }
    slots_[s] = static_cast<int>(voxels_.size());
    voxels_.emplace_back();
    voxels_.back().x = x, voxels_.back().y = y, voxels_.back().z = z;
    return voxels_.back();
  }
  /// The voxel, or null if it has no points.
  const VoxelSums* find(int x, int y, int z) const {
    std::size_t s = voxel_hash(x, y, z) & (slots_.size() - 1);
    for (; slots_[s] >= 0; s = (s + 1) & (slots_.size() - 1)) {
      const VoxelSums& c = voxels_[static_cast<std::size_t>(slots_[s])];
      if (c.x == x && c.y == y && c.z == z) return &c;
    }
    return nullptr;
  }
  const std::vector<VoxelSums>& voxels() const { return voxels_; }

 private:
  void grow() {
    slots_.assign(slots_.size() * 2, -1);
    for (std::size_t k = 0; k < voxels_.size(); ++k) {
      std::size_t s = voxel_hash(voxels_[k].x, voxels_[k].y, voxels_[k].z) & (slots_.size() - 1);
      while (slots_[s] >= 0) s = (s + 1) & (slots_.size() - 1);
      slots_[s] = static_cast<int>(k);
    }
  }
  std::vector<int> slots_;
  std::vector<VoxelSums> voxels_;
};

}  // namespace rayfield::slam
