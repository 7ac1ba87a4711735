#include "libdensity/posts/stem_thickness.h"

#include <algorithm>

#include "rayfield/core/median.h"

namespace rayfield::density {
namespace {

constexpr double kThick = 2.2;              // standard deviations
constexpr double kRatherThick = 1.5;        // the same
constexpr double kLeastThickM = 0.006;      // more than the median
constexpr double kThin = 1.2;               // standard deviations
constexpr double kMaybeSolid = 3;           // as in post_lattice.cpp
constexpr double kMadToDeviation = 1.4826;  // of normal deviates
constexpr std::size_t kLeastThick = 4;

}  // namespace

bool StemThickness::is_thick(const Stem& stem) const {
  return stem.radius_m > trunk_m + std::max(kThick * spread_m, kLeastThickM);
}

bool StemThickness::is_rather_thick(const Stem& stem) const {
  return stem.radius_m > trunk_m + std::max(kRatherThick * spread_m, kLeastThickM);
}

bool StemThickness::is_thin(const Stem& stem) const {
  return stem.radius_m < trunk_m + kThin * spread_m && stem.solidity < kMaybeSolid;
}

StemThickness stem_thickness(const std::vector<std::vector<PlacedStem>>& stems,
                             const std::vector<std::vector<std::size_t>>& sure) {
  StemThickness out;
  std::vector<double> radii, below;
  for (const auto& row : stems)
    for (const PlacedStem& stem : row) radii.push_back(stem.stem.radius_m);
  out.trunk_m = median_of(radii, 0);
  for (const double radius : radii)
    if (radius <= out.trunk_m) below.push_back(out.trunk_m - radius);
  out.spread_m = kMadToDeviation * median_of(below, 0);
  std::size_t thick = 0, thin = 0;
  for (std::size_t r = 0; r < stems.size(); ++r)
    for (std::size_t i = 1; i + 1 < stems[r].size(); ++i) {
      if (out.is_thick(stems[r][i].stem)) ++thick;
      if (std::binary_search(sure[r].begin(), sure[r].end(), i) && out.is_thin(stems[r][i].stem)) ++thin;
    }
  out.tells_posts = thick >= kLeastThick && thick > thin;
  return out;
}

std::vector<std::size_t> without_thin(const std::vector<PlacedStem>& stems, const std::vector<std::size_t>& sure,
                                      const StemThickness& thickness) {
  std::vector<std::size_t> kept = sure;
  if (thickness.tells_posts) std::erase_if(kept, [&](std::size_t i) { return thickness.is_thin(stems[i].stem); });
  return kept;
}

}  // namespace rayfield::density
