#include "rayfield/slam/options.h"

#include <cmath>

namespace rayfield::slam {
namespace {

constexpr const char* kCannotUse = "cannot use SLAM option";

}  // namespace

Result<void> SlamOptions::validate() const {
  RAYFIELD_CHECK(check_option_ranges(*this, kCannotUse));
  const auto at_most = [](const char* name, double value, const char* bound_name, double bound) -> Result<void> {
    if (value <= bound) return {};
    return fail(ErrorCode::usage, kCannotUse, name, std::string("it must not be larger than ") + bound_name);
  };
  RAYFIELD_CHECK(at_most("match.last_radius_voxels", match.last_radius_voxels, "match.first_radius_voxels",
                         match.first_radius_voxels));
  RAYFIELD_CHECK(at_most("match.last_cauchy", match.last_cauchy, "match.first_cauchy", match.first_cauchy));
  RAYFIELD_CHECK(at_most("window.advance_s", window.advance_s, "half of window.length_s", window.length_s / 2));
  RAYFIELD_CHECK(at_most("poles.reach_m", poles.reach_m, "poles.max_reach_m", poles.max_reach_m));
  RAYFIELD_CHECK(at_most("global.coarse_knots", global.coarse_knots, "global.fine_knots", global.fine_knots));
  // What one window of stage a sees at once is not a revisit.
  if (global.revisit_gap_s <= window.length_s)
    return fail(ErrorCode::usage, kCannotUse, "global.revisit_gap_s", "it must be larger than window.length_s");
  const double bins = window.advance_s / surfels.time_bin_s;
  if (std::abs(bins - std::round(bins)) > 1e-9 || bins < 1)
    return fail(ErrorCode::usage, kCannotUse, "window.advance_s", "it must be a whole multiple of surfels.time_bin_s");
  return {};
}

std::filesystem::path SlamOptions::scratch_directory() const {
  return scratch.empty() ? std::filesystem::temp_directory_path() : std::filesystem::path(scratch);
}

}  // namespace rayfield::slam
