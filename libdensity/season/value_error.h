#pragma once

#include "rayfield/core/products.h"

namespace rayfield::density {

/// The two errors in a panel's interval, as standard errors of leaf_area_m2, m².
struct ValueError {
  double own = 0;     ///< of the voxels: independent between dates and panels
  double shared = 0;  ///< common to all voxels of the scan
};

/// From se_leaf_area_m2 and ci_high_m2 (ci_low_m2 is cut at 0): shared² = ((ci_high − leaf)/1.96)² − own². Where the
/// wood is estimated, intervals reach further on one side; then the further one counts. A shared error is a factor
/// (interval.h), whose upper side is the larger one: 1 % more of it at 2.5 %, 8 % at 8 %.
ValueError error_of(const PanelValue& value);

}  // namespace rayfield::density
