#include "libdensity/ground/ground_model.h"
#include "libdensity/tiles/rounding.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rayfield::density {

void GroundModel::set(tile::TileIndex index, Grid2<float> nodes) { tiles_[index] = std::move(nodes); }

std::optional<double> GroundModel::height(double easting, double northing) const {
  if (!std::isfinite(easting) || !std::isfinite(northing)) return std::nullopt;
  const tile::TileIndex index{floor_int(easting / tile_size_m_), floor_int(northing / tile_size_m_)};
  const auto it = tiles_.find(index);
  if (it == tiles_.end()) return std::nullopt;
  const Grid2<float>& nodes = it->second;
  if (nodes.nx < 2 || nodes.ny < 2) return std::nullopt;

  // A point on the tile's far border may round to just past the last cell; it still belongs to that cell.
  const double fx = (easting - nodes.origin.x()) / nodes.cell_m;
  const double fy = (northing - nodes.origin.y()) / nodes.cell_m;
  const int ix = std::clamp(floor_int(fx), 0, nodes.nx - 2);
  const int iy = std::clamp(floor_int(fy), 0, nodes.ny - 2);
  const double u = std::clamp(fx - ix, 0.0, 1.0), v = std::clamp(fy - iy, 0.0, 1.0);
  const double z00 = static_cast<double>(nodes.at(ix, iy)), z10 = static_cast<double>(nodes.at(ix + 1, iy));
  const double z01 = static_cast<double>(nodes.at(ix, iy + 1)), z11 = static_cast<double>(nodes.at(ix + 1, iy + 1));
  const double z = (1 - v) * ((1 - u) * z00 + u * z10) + v * ((1 - u) * z01 + u * z11);
  if (!std::isfinite(z)) return std::nullopt;
  return z;
}

}  // namespace rayfield::density
