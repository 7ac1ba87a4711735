#pragma once

#include <cstddef>
#include <vector>

namespace rayfield {

/// Shape and index arithmetic of a dense 3-D lattice whose third index runs fastest: (i, j, k) has index
/// (i·nj + j)·nk + k. A column is all k of one (i, j). Indices are int, which suits loops and differences;
/// products are taken in std::size_t.
struct Shape3 {
  int ni = 0, nj = 0, nk = 0;

  std::size_t size() const { return columns() * static_cast<std::size_t>(nk); }
  std::size_t columns() const { return static_cast<std::size_t>(ni) * static_cast<std::size_t>(nj); }
  bool contains(int i, int j, int k) const { return i >= 0 && j >= 0 && k >= 0 && i < ni && j < nj && k < nk; }
  std::size_t column(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(nj) + static_cast<std::size_t>(j);
  }
  std::size_t index(int i, int j, int k) const {
    return column(i, j) * static_cast<std::size_t>(nk) + static_cast<std::size_t>(k);
  }
  bool operator==(const Shape3&) const = default;
};

/// A dense 3-D array over a Shape3.
template <class T>
struct Grid3 {
  Shape3 shape;
  std::vector<T> values;

  Grid3() = default;
  explicit Grid3(const Shape3& of, const T& fill = T()) : shape(of), values(of.size(), fill) {}

  T& at(int i, int j, int k) { return values[shape.index(i, j, k)]; }
  const T& at(int i, int j, int k) const { return values[shape.index(i, j, k)]; }
};

}  // namespace rayfield
