#include "libdensity/scan/scan_voxel_size.h"

#include <algorithm>
#include <cmath>

#include "libdensity/scan/echo_sample.h"
#include "libdensity/scan/stage_versions.h"

namespace rayfield::density {
namespace {

double fitted_size(double leaf_size_m2, const VoxelFitOptions& options) {
  // Whole millimetres: finer than the leaves are known, and no step between drives that see them a little different.
  const double side = std::round(options.leaf_sides * std::sqrt(leaf_size_m2) * 1000) / 1000;
  return std::clamp(side, options.min_m, options.max_m);
}

}  // namespace

Result<double> choose_voxel_size(ScanWork& work, const RowLayout& layout, const GroundModel& ground,
                                 const CanopyProfile& profile, std::span<const WoodCylinder> wood,
                                 const std::optional<EchoModel>& model) {
  const VoxelFitOptions& fit = work.options.voxel_fit;
  if (!fit.enabled) return work.options.segments.voxel_m;
  if (work.options.estimator.leaf_size_m2 > 0) return fitted_size(work.options.estimator.leaf_size_m2, fit);
  if (model) return fitted_size(model->leaf_size_m2, fit);
  KeyBuilder key("voxelsize", kVoxelSizeVersion);
  key.add(option_numbers(work.options.segments));
  key.add(option_numbers(work.voxels));
  key.add(option_numbers(fit)).add(work.layout_key).add(work.files.sha256("profile", "block"));
  for (const tile::TileEntry& entry : work.scan.tiles)
    key.add(entry.content_sha256()).add(work.files.sha256("ground", tile_name(entry.index)));
  const auto make = [&]() -> Result<tile::ArraySet> {
    RAYFIELD_ASSIGN(const RowSegmentList row_segments,
                    make_row_segments(layout, ground, profile, with_voxel_size(work.options.segments, fit.sample_m)));
    RAYFIELD_ASSIGN(const SampledEchoes sampled, sample_echoes(work, row_segments, wood, nullptr));
    tile::ArraySet arrays{.kind = "voxelsize", .attributes = "{}"};
    arrays.columns["voxel_m"] = std::vector<double>{fitted_size(estimate_leaf_size(sampled.pairs).area_m2, fit)};
    return arrays;
  };
  RAYFIELD_ASSIGN(const tile::ArraySet arrays, work.files.get("voxelsize", "block", key.hex(), make));
  RAYFIELD_ASSIGN(const auto column, arrays.column<double>("voxel_m"));
  if (column.size() != 1)
    return fail(ErrorCode::damaged, "cannot read derived data", "voxelsize", "it has no single value",
                "run `rayfield verify`");
  return column[0];
}

}  // namespace rayfield::density
