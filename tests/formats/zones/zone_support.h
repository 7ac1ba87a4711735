#pragma once

#include <cmath>
#include <stdexcept>
#include <vector>

#include "rayfield/formats/draw_zones.h"

/// A block of straight rows running east below a hilly surface.
namespace rayfield::formats::testing {

inline const Eigen::Vector2d kCorner(276196.4736, 6099944.0749);
inline constexpr int kRows = 12;
inline constexpr double kSpacing_m = 2.75, kRowLength_m = 60;

/// The value at a place, metres from the corner: 1 … 5.
inline double hill(double x, double y) { return 3 + 1.4 * std::sin(x / 9) + 0.6 * std::cos(y / 7); }

inline Grid2<double> hilly_surface() {
  Grid2<double> surface(kCorner - Eigen::Vector2d(5, 5), 0.5, 140, 90);
  for (int iy = 0; iy < surface.ny; ++iy)
    for (int ix = 0; ix < surface.nx; ++ix) {
      const Eigen::Vector2d p = surface.center(ix, iy) - kCorner;
      surface.at(ix, iy) = hill(p.x(), p.y());
    }
  return surface;
}

inline std::vector<std::vector<Eigen::Vector2d>> bands() {
  std::vector<std::vector<Eigen::Vector2d>> all;
  for (int row = 0; row < kRows; ++row) {
    const Eigen::Vector2d a = kCorner + Eigen::Vector2d(0, kSpacing_m * row);
    const Eigen::Vector2d b = a + Eigen::Vector2d(kRowLength_m, kSpacing_m);
    all.push_back({a, {b.x(), a.y()}, b, {a.x(), b.y()}, a});
  }
  return all;
}

/// Three classes between 2.5 and 3.5.
inline ZoneMap drawn_map(double min_zone_m2) {
  ZoneMap map;
  map.block = "block a", map.crs = "EPSG:7854", map.snapshot = 7;
  map.scan.scan_id = map.scan.scan_date = "2019-02-11";
  map.value = "leaf_area_per_m", map.unit = "m2/m";
  auto zones = draw_zones(hilly_surface(), std::vector<double>{2.5, 3.5}, bands(), min_zone_m2);
  if (!zones) throw std::runtime_error(zones.error().line());
  map.zones = std::move(*zones);
  for (const ManagementZone& zone : map.zones) map.area_m2 += zone.area_m2;
  return map;
}

}  // namespace rayfield::formats::testing
