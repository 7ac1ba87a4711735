#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace rayfield::slam {

/// Sums over the points of a voxel, relative to an origin near them.
struct Cell {
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

inline std::uint64_t cell_hash(int x, int y, int z) {
  return mix_bits(static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) * 73856093u ^
                  static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) * 19349663u ^
                  static_cast<std::uint64_t>(static_cast<std::uint32_t>(z)) * 83492791u);
}

/// Open addressing over cells in order of first touch, which depends on the points' order only.
class CellMap {
 public:
  explicit CellMap(std::size_t expected) {
    std::size_t capacity = 64;
    while (capacity < 2 * expected) capacity *= 2;
    slots_.assign(capacity, -1);
  }
  Cell& at(int x, int y, int z) {
    if (2 * (cells_.size() + 1) > slots_.size()) grow();
    std::size_t s = cell_hash(x, y, z) & (slots_.size() - 1);
    while (slots_[s] >= 0) {
      Cell& c = cells_[static_cast<std::size_t>(slots_[s])];
      if (c.x == x && c.y == y && c.z == z) return c;
      s = (s + 1) & (slots_.size() - 1);
    }
    slots_[s] = static_cast<int>(cells_.size());
    cells_.emplace_back();
    cells_.back().x = x, cells_.back().y = y, cells_.back().z = z;
    return cells_.back();
  }
  /// The cell, or null where there are no points.
  const Cell* find(int x, int y, int z) const {
    std::size_t s = cell_hash(x, y, z) & (slots_.size() - 1);
    for (; slots_[s] >= 0; s = (s + 1) & (slots_.size() - 1)) {
      const Cell& c = cells_[static_cast<std::size_t>(slots_[s])];
      if (c.x == x && c.y == y && c.z == z) return &c;
    }
    return nullptr;
  }
  const std::vector<Cell>& cells() const { return cells_; }

 private:
  void grow() {
    slots_.assign(slots_.size() * 2, -1);
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      std::size_t s = cell_hash(cells_[k].x, cells_[k].y, cells_[k].z) & (slots_.size() - 1);
      while (slots_[s] >= 0) s = (s + 1) & (slots_.size() - 1);
      slots_[s] = static_cast<int>(k);
    }
  }
  std::vector<int> slots_;
  std::vector<Cell> cells_;
};

}  // namespace rayfield::slam
