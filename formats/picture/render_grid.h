#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "rayfield/core/grid2.h"
#include "rayfield/formats/style.h"

namespace rayfield::formats {

/// An axis-aligned window in the plane of a grid, m.
struct PlaneBox {
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();
  Eigen::Vector2d size() const { return high - low; }
};

/// The window as an image, first row on top (largest y). A pixel shows the area-weighted mean of the cells under it,
/// cells without a value left out; its alpha is the share of its area that has values.
std::vector<Rgba> render_grid(const Grid2<float>& grid, const ColorScale& scale, const PlaneBox& window, int width_px,
                              int height_px);

/// Smallest and largest value; NaN, NaN without any.
std::pair<double, double> value_range(const Grid2<float>& grid);

/// The bounding box of the cells that hold a value; false without any.
bool value_bounds(const Grid2<float>& grid, PlaneBox& box);

}  // namespace rayfield::formats
