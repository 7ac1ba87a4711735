#include "rayfield/density/voxel_block.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "libdensity/echoes/echo_model.h"
#include "libdensity/estimate/row_density.h"
#include "libdensity/voxels/voxel_accumulator.h"

namespace rayfield::density {
namespace {

constexpr double kBorderM = 1;  // between the block and the border of the tile that it is given

/// The block in a tile of its own: one row segment on level ground.
struct Scene {
  tile::TileRef tile;
  RowSegment row_segment;
  Eigen::Vector3d shift;  ///< tile_from_block
};

Scene scene_of(const VoxelBlock& block) {
  Scene scene;
  scene.shift = Eigen::Vector3d(kBorderM, kBorderM, 0) - block.low_m;
  scene.tile.size_m = 2 * kBorderM + block.voxel_m * std::max(block.n_along, block.n_across);
  RowSegment& s = scene.row_segment;
  s.row = 1;
  s.origin = {kBorderM, kBorderM};
  s.n_along = block.n_along, s.n_across = block.n_across, s.n_up = block.n_up;
  s.across_min_m = 0, s.up_min_m = 0, s.voxel_m = block.voxel_m;
  return scene;
}

tile::SegmentBatch segments_of(const RayBatch& rays, const Eigen::Vector3d& shift) {
  tile::SegmentBatch segments;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    segments.entry.push_back(rays.origin[i] + shift), segments.exit.push_back(rays.end[i] + shift);
    segments.time_s.push_back(rays.time_s[i]), segments.intensity.push_back(rays.intensity[i]);
    const int hit = rays.hit[i] != 0 ? tile::kHit : 0;
    segments.flags.push_back(static_cast<std::uint8_t>(tile::kStartsHere | tile::kEndsHere | hit));
  }
  return segments;
}

/// nullptr for thin beams.
std::shared_ptr<const BeamView> view_of(const tile::SegmentBatch& segments, const std::optional<LidarBeam>& beam,
                                        const BeamOptions& options) {
  if (!options.enabled || !beam || !(beam->diameter_m > 0 || beam->divergence_rad > 0)) return nullptr;
  std::vector<PathPoint> track;
  for (std::size_t i = 0; i < segments.size(); ++i)
    if (track.empty() || segments.time_s[i] > track.back().time_s)
      track.push_back({segments.time_s[i], segments.entry[i]});
  return std::make_shared<const BeamView>(beam_view(*beam, SensorTrack(std::move(track)), options));
}

}  // namespace

Result<VoxelBlockDensity> estimate_voxel_block(const VoxelBlock& block, const RayBatch& rays,
                                               const std::optional<LidarBeam>& beam, const VoxelBlockOptions& options) {
  RAYFIELD_CHECK(options.beam.validate());
  const Scene scene = scene_of(block);
  const std::span<const RowSegment> row_segments(&scene.row_segment, 1);
  const tile::SegmentBatch segments = segments_of(rays, scene.shift);
  const auto view = view_of(segments, beam, options.beam);
  RAYFIELD_ASSIGN(VoxelAccumulator counters,
                  VoxelAccumulator::create(scene.tile, row_segments, {}, options.voxels, view));
  std::optional<EchoModel> model;
  if (view) {
    VoxelAccumulator sampled = counters;
    sampled.add_pairs(segments);
    model = estimate_echo_model(*sampled.echo_statistics(), {view->beam, resolution_of(view->beam, options.beam),
                                                             options.beam.full_echo, options.estimator.leaf_size_m2});
  }
  RAYFIELD_CHECK(counters.add(segments));
  const TileVoxels voxels = std::move(counters).finish();
  RAYFIELD_ASSIGN(RowDensityBuilder builder,
                  RowDensityBuilder::create(1, row_segments, {}, voxels.pairs, options.estimator, model));
  RAYFIELD_CHECK(builder.add(voxels));
  RowDensity row = std::move(builder).finish();
  VoxelBlockDensity out;
  for (int a = 0; a < row.n_along; ++a)
    for (int c = 0; c < row.n_across; ++c)
      for (int u = 0; u < row.n_up; ++u) out.area_m2 += row.canopy_area(a, c, u);
  out.leaf_size_m2 = row.leaf_size_m2;
  out.density_m2_m3 = std::move(row.density);
  if (model) out.echoes = BlockEchoes{model->full_echo, model->detection_share, model->leaf_size_m2};
  return out;
}

}  // namespace rayfield::density
