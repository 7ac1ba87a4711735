#pragma once
/// evidence: what the landmarks of two scans say about a shift between them.
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "rayfield/core/landmarks.h"

namespace rayfield::align {

/// Uprights by place.
class UprightIndex {
 public:
  /// `uprights` must outlive the index. `cell_m`: the largest radius that will be asked for.
  UprightIndex(std::span<const Upright> uprights, double cell_m);
  /// The nearest one within `radius_m` (at most cell_m), or -1.
  int nearest(const Eigen::Vector2d& p, double radius_m) const;
  /// All within `radius_m`, however large, ascending.
  std::vector<int> within(const Eigen::Vector2d& p, double radius_m) const;

 private:
  std::int64_t key(std::int64_t ix, std::int64_t iy) const { return ix * (std::int64_t{1} << 31) + iy; }
  std::span<const Upright> uprights_;
  double cell_m_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  std::unordered_map<std::int64_t, std::vector<int>> cells_;
};

}  // namespace rayfield::align
