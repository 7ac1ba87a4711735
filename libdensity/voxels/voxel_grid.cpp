#include "libdensity/voxels/voxel_grid.h"

#include <cmath>

namespace rayfield::density {

VoxelCounters& VoxelCounters::operator+=(const VoxelCounters& other) {
  rays += other.rays, hits += other.hits;
  path += other.path, hit_path += other.hit_path;
  potential += other.potential;
  return *this;
}

EchoCounters& EchoCounters::operator+=(const EchoCounters& other) {
  echo += other.echo;
  width += other.width;
  behind += other.behind, echo_behind += other.echo_behind;
  return *this;
}

std::size_t counter_bytes(std::span<const RowSegmentVoxels> row_segments) {
  std::size_t bytes = 0;
  for (const RowSegmentVoxels& s : row_segments)
    bytes += s.voxels.size() * sizeof(VoxelCounters) + s.echoes.size() * sizeof(EchoCounters) +
             s.directions.size() * sizeof(DirectionCounters);
  return bytes;
}

Eigen::Vector2d column_center(const RowSegment& s, int along, int across) {
  const double a = (along + 0.5) * s.voxel_m, c = s.across_min_m + (across + 0.5) * s.voxel_m;
  return s.origin + a * s.direction + c * Eigen::Vector2d(-s.direction.y(), s.direction.x());
}

RowSegmentVoxels empty_voxels(const RowSegment& s, const tile::TileRef& tile, bool wide) {
  RowSegmentVoxels out;
  out.row_segment = s;
  out.column.assign(s.shape().columns(), -1);
  std::int32_t next = 0;
  std::size_t i = 0;
  for (int a = 0; a < s.n_along; ++a) {
    for (int c = 0; c < s.n_across; ++c, ++i) {
      const Eigen::Vector2d p = column_center(s, a, c) / tile.size_m;
      if (std::floor(p.x()) == tile.index.ix && std::floor(p.y()) == tile.index.iy) out.column[i] = next++;
    }
  }
  out.entries.assign(static_cast<std::size_t>(next), 0);
  out.voxels.assign(static_cast<std::size_t>(next) * static_cast<std::size_t>(s.n_up), {});
  if (wide) out.echoes.assign(out.voxels.size(), {});
  return out;
}

}  // namespace rayfield::density
