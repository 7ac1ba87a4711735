#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libdensity/posts/posts.h"
#include "rayfield/core/grid3.h"

namespace rayfield::density {

/// Fine counts of hits along one row: cells along × across × layers of height, saturating at 255.
/// Cell (a, c) has its centre at chainage (first_along + a + ½)·cell and across (c + ½)·cell − half_width.
struct StemGrid {
  int row = 0;  ///< index into RowLayout::rows
  int first_along = 0, n_along = 0, n_across = 0, n_layers = 0;
  double cell_m = 0.02, layer_m = 0.1, half_width_m = 0.35;
  std::vector<std::uint8_t> counts;  ///< ((a·n_across) + c)·n_layers + layer

  Shape3 shape() const { return {n_along, n_across, n_layers}; }
  std::span<const std::uint8_t> column(int a, int c) const {
    return std::span<const std::uint8_t>(counts).subspan(shape().index(a, c, 0), static_cast<std::size_t>(n_layers));
  }
  double along_m(int a) const { return (first_along + a + 0.5) * cell_m; }
  double across_m(int c) const { return (c + 0.5) * cell_m - half_width_m; }
};

/// A stem in row coordinates; x = chainage, y = across.
struct GridStem {
  Eigen::Vector2d foot = Eigen::Vector2d::Zero();
  Eigen::Vector2d lean = Eigen::Vector2d::Zero();
  double radius_m = 0, top_m = 0, contrast = 0, upper_share = 0, solidity = 0;
};

/// Upright thin cylinders in one row's grid, ascending chainage.
std::vector<GridStem> find_stems(const StemGrid& grid, const PostOptions& options);

}  // namespace rayfield::density
