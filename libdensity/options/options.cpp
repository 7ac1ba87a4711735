#include "rayfield/density/options.h"

#include <algorithm>
#include <cmath>

namespace rayfield::density {
namespace {

// The value of that name. Errors: usage, `what`.
template <class E, std::size_t N>
Result<E> parse_choice(std::string_view name, const OptionChoices<E, N>& choices, std::string_view what) {
  std::string all;
  for (const auto& [text, choice] : choices) {
    if (text == name) return choice;
    all.append(all.empty() ? "" : ", ").append(text);
  }
  return fail(ErrorCode::usage, what, name, "not one of the known names", "use one of: " + all);
}

}  // namespace

Result<void> RowSegmentOptions::validate() const {
  constexpr const char* kWhat = "cannot lay out the voxels";
  RAYFIELD_CHECK(check_option_ranges(*this, kWhat));
  if (max_height_m >= up_min_m + min_height_m) return {};
  return fail(ErrorCode::usage, kWhat, "max_height_m", "it is below up_min_m + min_height_m", "see docs/options.md");
}

RowSegmentOptions with_voxel_size(const RowSegmentOptions& options, double voxel_m) {
  RowSegmentOptions changed = options;
  changed.voxel_m = voxel_m;
  if (!(voxel_m > 0)) return changed;  // refused by validate()
  changed.voxels_per_segment =
      std::max(4, static_cast<int>(std::lround(options.voxels_per_segment * options.voxel_m / voxel_m)));
  return changed;
}

Result<void> VoxelFitOptions::validate() const {
  constexpr const char* kWhat = "cannot fit the voxels";
  RAYFIELD_CHECK(check_option_ranges(*this, kWhat));
  if (max_m >= min_m) return {};
  return fail(ErrorCode::usage, kWhat, "max_m", "it is below min_m", "see docs/options.md");
}

Result<LeafAngleType> parse_leaf_angle_type(std::string_view name) {
  return parse_choice(name, kLeafAngleTypes, "unknown leaf angle distribution");
}

Result<void> LeafAngles::validate() const { return check_option_ranges(*this, "bad leaf angle option"); }

Result<void> VoxelOptions::validate() const { return check_option_ranges(*this, "bad voxel option"); }

Result<void> BeamOptions::validate() const { return check_option_ranges(*this, "bad beam option"); }

Result<Estimator> parse_estimator(std::string_view name) {
  return parse_choice(name, kEstimators, "unknown estimator");
}

Result<void> EstimatorOptions::validate() const { return check_option_ranges(*this, "bad density option"); }

Result<void> IntegrationOptions::validate() const { return check_option_ranges(*this, "bad integration option"); }

Result<void> WoodPriorOptions::validate() const { return check_option_ranges(*this, "bad wood option"); }

Result<void> LeafOptions::validate() const { return check_option_ranges(*this, "bad leaf area option"); }

Result<void> DescriptorOptions::validate() const {
  constexpr const char* kWhat = "bad canopy descriptor option";
  RAYFIELD_CHECK(check_option_ranges(*this, kWhat));
  if (fruit_zone_high_m > fruit_zone_low_m) return {};
  return fail(ErrorCode::usage, kWhat, "fruit_zone_high_m", "it is not above fruit_zone_low_m", "see docs/options.md");
}

Result<void> PlanRasterOptions::validate() const { return check_option_ranges(*this, "bad raster option"); }

Result<void> ProcessOptions::validate() const {
  RAYFIELD_CHECK(check_option_ranges(*this, "bad option"));
  RAYFIELD_CHECK(canopy.validate());
  RAYFIELD_CHECK(posts.validate());
  RAYFIELD_CHECK(segments.validate());
  RAYFIELD_CHECK(descriptors.validate());
  return voxel_fit.validate();
}

}  // namespace rayfield::density
