#include "libdensity/cloud/hit_locator.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

namespace rayfield::density {
namespace {

/// The index covers the tile and a little more, so that no point of the tile lies on its border.
constexpr double kAroundM = 0.5;

Eigen::AlignedBox2d around(const tile::TileRef& tile) {
  const Eigen::Array2d corner = tile.corner().array();
  return {Eigen::Vector2d(corner - kAroundM), Eigen::Vector2d(corner + tile.size_m + kAroundM)};
}

/// Number of the voxel that holds `g` among those stored of the row segment. The grid's far faces belong to it, as they
/// do where rays are counted.
std::optional<std::size_t> voxel_at(const SegmentDensities& s, const Eigen::Vector3d& g) {
  const int n[3] = {s.row_segment.n_along, s.row_segment.n_across, s.row_segment.n_up};
  int i[3];
  for (int k = 0; k < 3; ++k) {
    if (!(g[k] >= 0 && g[k] <= n[k])) return std::nullopt;
    i[k] = std::min(static_cast<int>(g[k]), n[k] - 1);
  }
  return s.stored_shape().index(i[0], i[1] + s.across_shift, i[2] + s.up_shift);
}

}  // namespace

HitLocator::HitLocator(Scene scene, const tile::TileRef& tile) : scene_(std::move(scene)) {
  std::vector<RowSegment> row_segments;
  for (const SegmentDensities& s : scene_.segments) {
    row_segments.push_back(s.row_segment);
    frames_.emplace_back(s.row_segment);
  }
  index_ = VoxelIndex(row_segments, scene_.wood, scene_.wood_shell_m, around(tile));
}

std::optional<HitLocator::Found> HitLocator::find(const Eigen::Vector3d& p_in_map, Mask& mask) const {
  if (!index_.candidates(p_in_map, Eigen::Vector3d::Zero(), 0, mask.data())) return std::nullopt;
  std::optional<std::size_t> segment, voxel;
  bool on_wood = false;
  for (std::size_t w = 0; w < mask.size(); ++w)
    for (std::uint64_t bits = std::exchange(mask[w], 0); bits != 0; bits &= bits - 1) {
      const std::size_t item = w * 64 + static_cast<std::size_t>(std::countr_zero(bits));
      if (item >= frames_.size()) {
        on_wood = on_wood || in_shell(scene_.wood[item - frames_.size()], scene_.wood_shell_m, p_in_map);
      } else if (!voxel) {
        segment = item;
        voxel = voxel_at(scene_.segments[item], frames_[item].grid_from_map(p_in_map));
      }
    }
  if (!voxel) return std::nullopt;
  if (on_wood) return Found{PointKind::wood, std::numeric_limits<float>::quiet_NaN()};
  return Found{PointKind::canopy, scene_.values[*segment][*voxel]};
}

}  // namespace rayfield::density
