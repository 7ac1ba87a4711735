#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libdensity/ground/ground_model.h"
#include "libdensity/layout/row_layout.h"
#include "libdensity/voxels/canopy_profile.h"
#include "rayfield/core/result.h"
#include "rayfield/density/options.h"
#include "rayfield/tile/arrays.h"
#include "rayfield/tile/segments.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// The grid's faces for one row of one scan.
struct RowExtents {
  int row = 0;
  std::int64_t hits = 0;
  double across_low_m = 0, across_high_m = 0, up_high_m = 0;  ///< the quantiles; NaN without hits
  double across_min_m = 0, across_max_m = 0, up_max_m = 0;    ///< faces, whole voxels
  double outside_share = 0;  ///< of the hits beyond the faces (across plus above), an upper bound of what is cut off
};

/// Faces from quantiles, widened, at least the minimum and at most half the row spacing, snapped to whole voxels.
/// Rows without hits get the minimum, so that they are reported as scanned and empty where rays cross them.
std::vector<RowExtents> row_extents(const RowLayout& layout, const CanopyProfile& profile,
                                    const RowSegmentOptions& options);

struct RowSegmentList {
  std::vector<RowSegment> row_segments;  ///< by row, then along
  std::vector<RowExtents> extents;
  std::vector<std::string> warnings;  ///< row segments left out, with the reason
};

/// Cuts every row into row segments. A row segment whose ground is unknown is left out and named in the warnings.
Result<RowSegmentList> make_row_segments(const RowLayout& layout, const GroundModel& ground,
                                         const CanopyProfile& profile, const RowSegmentOptions& options);

}  // namespace rayfield::density
