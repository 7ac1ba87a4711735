#include "libdensity/pipeline/option_keys.h"

#include <limits>

namespace rayfield::density {
namespace {

// All as doubles: the integers among the options are small.
KeyBuilder& add_numbers(KeyBuilder& key, std::initializer_list<double> numbers) {
  return key.add(std::vector<double>(numbers));
}

}  // namespace

KeyBuilder& add_options(KeyBuilder& key, const SurveyOptions& o) {
  return add_numbers(
      key, {o.ground_cell_m, o.ground_bin_m, static_cast<double>(o.ground_bins), o.coverage_cell_m, o.path_step_s});
}

KeyBuilder& add_options(KeyBuilder& key, const GroundOptions& o) {
  return add_numbers(key, {o.curvature_per_m, o.halo_m, static_cast<double>(o.min_support), o.support_m, o.max_drop_m,
                           o.max_rise_m, o.fit_radius_m, o.max_gap_m});
}

KeyBuilder& add_options(KeyBuilder& key, const CanopyMapOptions& o) {
  return add_numbers(key, {o.cell_m, o.stem_min_m, o.canopy_min_m, o.canopy_max_m, o.tall_min_m, o.tall_max_m});
}

KeyBuilder& add_options(KeyBuilder& key, const RowOptions& o) {
  return add_numbers(key, {o.passes.spacing_m, o.passes.min_length_m, o.passes.min_radius_m, o.passes.max_jump_m,
                           o.min_offset_m, o.max_offset_m, o.half_width_m, o.max_gap_m, o.min_length_m, o.min_cover,
                           o.min_strength_share, o.max_tall_share, o.max_lane_share, o.smoothing_m});
}

KeyBuilder& add_options(KeyBuilder& key, const PostOptions& o) {
  return add_numbers(key, {o.half_width_m, o.cell_m, o.layer_m, o.top_m, o.low_min_m, o.low_max_m, o.min_contrast,
                           o.min_post_height_m, o.min_panel_m, o.max_panel_m, o.smoothing_m,
                           o.panel_length_m.value_or(std::numeric_limits<double>::infinity())});
}

KeyBuilder& add_options(KeyBuilder& key, const RowSegmentOptions& o) {
  return add_numbers(key, {o.voxel_m, static_cast<double>(o.voxels_per_segment), o.up_min_m, o.across_low,
                           o.across_high, o.up_high, static_cast<double>(o.widen_voxels), o.min_half_width_m,
                           o.min_height_m, o.max_height_m, o.lone_half_width_m});
}

KeyBuilder& add_options(KeyBuilder& key, const VoxelOptions& o) {
  return add_numbers(key, {static_cast<double>(o.leaf_angles.type), o.leaf_angles.ellipsoid_ratio, o.wood_shell_m,
                           o.sure_return_m, o.slope_margin});
}

KeyBuilder& add_options(KeyBuilder& key, const VoxelFitOptions& o) {
  return add_numbers(key, {o.leaf_sides, o.min_m, o.max_m, o.sample_m});
}

KeyBuilder& add_options(KeyBuilder& key, const EstimatorOptions& o) {
  return add_numbers(
      key, {static_cast<double>(o.estimator), o.leaf_size_m2, static_cast<double>(o.paper_min_rays), o.shared_error});
}

KeyBuilder& add_options(KeyBuilder& key, const IntegrationOptions& o) {
  return add_numbers(key, {o.height_share, o.width_share, o.min_observed_fraction, o.shared_error, o.metre_step_m});
}

KeyBuilder& add_options(KeyBuilder& key, const PlanRasterOptions& o) {
  return add_numbers(key, {o.cell_m, o.height_share});
}

}  // namespace rayfield::density
