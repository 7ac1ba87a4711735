#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace rayfield {

/// A dense 2-D grid over map coordinates. Cell (ix, iy) covers the half-open square
/// [origin + (ix, iy)·cell, origin + (ix+1, iy+1)·cell); rows go north (iy up), columns east.
template <class T>
struct Grid2 {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< south-west corner, m
  double cell_m = 1;
  int nx = 0, ny = 0;
  std::vector<T> values;  ///< nx·ny, index iy·nx + ix

  Grid2() = default;
  Grid2(const Eigen::Vector2d& south_west, double cell_size_m, int columns, int rows, const T& fill = T())
      : origin(south_west),
        cell_m(cell_size_m),
        nx(columns),
        ny(rows),
        values(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), fill) {}

  bool contains(int ix, int iy) const { return ix >= 0 && iy >= 0 && ix < nx && iy < ny; }
  std::size_t index(int ix, int iy) const {
    return static_cast<std::size_t>(iy) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(ix);
  }
  T& at(int ix, int iy) { return values[index(ix, iy)]; }
  const T& at(int ix, int iy) const { return values[index(ix, iy)]; }
  Eigen::Vector2d center(int ix, int iy) const { return origin + cell_m * Eigen::Vector2d(ix + 0.5, iy + 0.5); }
};

}  // namespace rayfield
