#include "rayfield/formats/farm_profile.h"

#include <algorithm>
#include <array>

namespace rayfield::formats {
namespace {

constexpr std::array<FarmProfile, 4> kProfiles = {{
    {"plain", "", true, true, false, 0, 0},
    // One .shp, .shx and .dbf each, at most 100 zones: dev.fieldview.com/rx-format.
    {"fieldview", "", false, false, false, 0, 100},
    // Numbers only, at most 20 of them, one data set per archive: docs.geopard.tech, "As-Applied/As-Planted Data
    // Import".
    {"geopard", "", true, false, true, 20, 0},
    // The shapefile in a folder Rx: docs.withleaf.io/beta/prescriptions.
    {"deere", "Rx/", true, false, false, 0, 0},
}};

}  // namespace

std::span<const FarmProfile> farm_profiles() { return kProfiles; }

const FarmProfile* find_farm_profile(std::string_view name) {
  const auto found = std::find_if(kProfiles.begin(), kProfiles.end(),
                                  [&](const FarmProfile& profile) { return profile.name == name; });
  return found == kProfiles.end() ? nullptr : &*found;
}

}  // namespace rayfield::formats
