#include "rayfield/density/layout_options.h"

namespace rayfield::density {

Result<void> SurveyOptions::validate() const { return check_option_ranges(*this, "cannot survey the tiles"); }

Result<void> GroundOptions::validate() const { return check_option_ranges(*this, "cannot find the ground"); }

Result<void> CanopyMapOptions::validate() const {
  constexpr const char* kWhat = "cannot map the canopy";
  RAYFIELD_CHECK(check_option_ranges(*this, kWhat));
  const bool ascending =
      canopy_min_m > stem_min_m && canopy_max_m > canopy_min_m && tall_min_m >= canopy_max_m && tall_max_m > tall_min_m;
  if (ascending) return {};
  return fail(ErrorCode::usage, kWhat, "stem_min_m … tall_max_m", "the heights do not ascend",
              "give layers from below, without overlap");
}

Result<void> PassOptions::validate() const { return check_option_ranges(*this, "cannot find the passes"); }

Result<void> RowOptions::validate() const { return check_option_ranges(*this, "cannot find the rows"); }

Result<void> PostOptions::validate() const {
  constexpr const char* kWhat = "cannot find the posts";
  RAYFIELD_CHECK(check_option_ranges(*this, kWhat));
  if (!(low_max_m >= low_min_m + 2 * layer_m))
    return fail(ErrorCode::usage, kWhat, "low_max_m", "it is less than two layers above low_min_m",
                "see docs/options.md");
  if (!(max_panel_m >= min_panel_m))
    return fail(ErrorCode::usage, kWhat, "max_panel_m", "it is below min_panel_m", "see docs/options.md");
  return {};
}

Result<void> RegistryOptions::validate() const { return check_option_ranges(*this, "cannot keep the registry"); }

}  // namespace rayfield::density
