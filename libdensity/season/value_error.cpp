#include "libdensity/season/value_error.h"

#include <algorithm>
#include <cmath>

namespace rayfield::density {

ValueError error_of(const PanelValue& value) {
  const double own = value.se_leaf_area_m2, whole = (value.ci_high_m2 - value.leaf_area_m2) / kNormal95;
  return {own, std::sqrt(std::max(0.0, whole * whole - own * own))};
}

}  // namespace rayfield::density
