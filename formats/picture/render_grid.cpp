#include "formats/picture/render_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/picture/color.h"

namespace rayfield::formats {
namespace {

/// The cells under one pixel along one axis: first … last, the outer ones in part.
struct Span {
  int first = 0, last = -1;
  double first_weight = 0, last_weight = 0;  ///< covered share of the outer cells; pixel size in cells is the total
};

std::vector<Span> spans(double origin, double cell_m, int cells, double low, double high, int pixels) {
  std::vector<Span> out(static_cast<std::size_t>(pixels));
  for (int i = 0; i < pixels; ++i) {
    const double from = (low + (high - low) * i / pixels - origin) / cell_m;
    const double to = (low + (high - low) * (i + 1) / pixels - origin) / cell_m;
    const double begin = std::max(from, 0.0), end = std::min(to, static_cast<double>(cells));
    Span& span = out[static_cast<std::size_t>(i)];
    if (!(end > begin)) continue;
    span.first = std::min(static_cast<int>(begin), cells - 1);
    span.last = std::max(span.first, std::min(static_cast<int>(std::ceil(end)) - 1, cells - 1));
    span.first_weight = std::min(end, span.first + 1.0) - begin;
    span.last_weight = end - std::max(begin, static_cast<double>(span.last));
  }
  return out;
}

double weight(const Span& span, int i) {
  if (i == span.first) return span.first_weight;
  return i == span.last ? span.last_weight : 1.0;
}

}  // namespace

std::vector<Rgba> render_grid(const Grid2<float>& grid, const ColorScale& scale, const PlaneBox& window, int width_px,
                              int height_px) {
  const std::vector<Span> columns =
      spans(grid.origin.x(), grid.cell_m, grid.nx, window.low.x(), window.high.x(), width_px);
  const std::vector<Span> rows =
      spans(grid.origin.y(), grid.cell_m, grid.ny, window.low.y(), window.high.y(), height_px);
  const double pixel_area = window.size().x() / width_px * window.size().y() / height_px / (grid.cell_m * grid.cell_m);
  std::vector<Rgba> pixels(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), Rgba{0, 0, 0, 0});
  for (int y = 0; y < height_px; ++y) {
    const Span& row = rows[static_cast<std::size_t>(height_px - 1 - y)];
    for (int x = 0; x < width_px; ++x) {
      const Span& column = columns[static_cast<std::size_t>(x)];
      double sum = 0, area = 0;
      for (int iy = row.first; iy <= row.last; ++iy) {
        for (int ix = column.first; ix <= column.last; ++ix) {
          const float value = grid.at(ix, iy);
          if (std::isnan(value)) continue;
          const double w = weight(column, ix) * weight(row, iy);
          sum += w * static_cast<double>(value);
          area += w;
        }
      }
      if (!(area > 0)) continue;
      Rgba color = color_at(scale, sum / area);
      color.a = static_cast<std::uint8_t>(std::lround(255 * std::clamp(area / pixel_area, 0.0, 1.0)));
      pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(x)] = color;
    }
  }
  return pixels;
}

std::pair<double, double> value_range(const Grid2<float>& grid) {
  double low = std::numeric_limits<double>::quiet_NaN(), high = low;
  for (const float cell : grid.values) {
    if (std::isnan(cell)) continue;
    const double value = static_cast<double>(cell);
    low = std::isnan(low) ? value : std::min(low, value);
    high = std::isnan(high) ? value : std::max(high, value);
  }
  return {low, high};
}

bool value_bounds(const Grid2<float>& grid, PlaneBox& box) {
  int low_x = grid.nx, low_y = grid.ny, high_x = -1, high_y = -1;
  for (int iy = 0; iy < grid.ny; ++iy) {
    for (int ix = 0; ix < grid.nx; ++ix) {
      if (std::isnan(grid.at(ix, iy))) continue;
      low_x = std::min(low_x, ix), high_x = std::max(high_x, ix);
      low_y = std::min(low_y, iy), high_y = std::max(high_y, iy);
    }
  }
  if (high_x < 0) return false;
  box.low = grid.origin + grid.cell_m * Eigen::Vector2d(low_x, low_y);
  box.high = grid.origin + grid.cell_m * Eigen::Vector2d(high_x + 1, high_y + 1);
  return true;
}

}  // namespace rayfield::formats
