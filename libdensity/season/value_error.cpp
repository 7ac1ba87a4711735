#include "libdensity/season/value_error.h"
#include "libdensity/integration/interval.h"

#include <algorithm>
#include <cmath>

namespace rayfield::density {

ValueError error_of(const PanelValue& value) {
  double half = value.ci_high_m2 - value.leaf_area_m2;
  if (value.wood_from == kWoodFromEstimate) half = std::max(half, value.leaf_area_m2 - value.ci_low_m2);
  const double own = value.se_leaf_area_m2, whole = half / kNormal95;
  return {own, std::sqrt(std::max(0.0, whole * whole - own * own))};
}

}  // namespace rayfield::density
