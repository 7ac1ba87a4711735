#pragma once

#include <ogr_geometry.h>

#include <memory>
#include <vector>

#include "rayfield/core/grid2.h"
#include "rayfield/core/result.h"

namespace rayfield::formats {

/// A piece of a block between contours.
struct ZoneFace {
  std::unique_ptr<OGRPolygon> polygon;
  double area_m2 = 0;
  int zone = 0;  ///< from 0
};

/// A border that two faces share.
struct SharedBorder {
  std::size_t a = 0, b = 0;
  double length_m = 0;
};

/// Pairs of faces that touch along a line.
std::vector<SharedBorder> shared_borders(const std::vector<ZoneFace>& faces);

/// Gives connected faces of one zone that are together smaller than `min_area_m2` the zone of the neighbour with which
/// they share the longest border, the smallest first, until none is left that has a neighbour.
void absorb_small_parts(std::vector<ZoneFace>& faces, const std::vector<SharedBorder>& borders, double min_area_m2);

}  // namespace rayfield::formats
