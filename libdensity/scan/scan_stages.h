#pragma once

#include <string>
#include <vector>

#include "libdensity/ground/ground_model.h"
#include "libdensity/ground/scan_survey.h"
#include "libdensity/layout/row_layout.h"
#include "libdensity/posts/posts.h"
#include "libdensity/rows/canopy_map.h"
#include "libdensity/scan/scan_work.h"
#include "libdensity/voxels/row_segments.h"

namespace rayfield::density {

/// The first stages, which need nothing but the rays.
struct SurveyedScan {
  ScanSurvey survey;
  GroundModel ground;
};
Result<SurveyedScan> survey_scan(ScanWork& work);
/// The first half of it.
Result<ScanSurvey> survey_tiles(ScanWork& work);

/// The upright things that the scan shows along these rows.
Result<std::vector<Stem>> stems_along(ScanWork& work, const GroundModel& ground, const RowLayout& rows);

/// For the canopy of all tiles of the scan. Errors: resources, when memory has no room for them.
Result<CanopyMap> empty_canopy_map(const ScanWork& work);

/// Rows, posts and panels from one scan: the block's layout, when there is none yet.
struct FoundLayout {
  RowLayout layout;
  std::vector<std::string> notes;
};
Result<FoundLayout> find_layout(ScanWork& work, const SurveyedScan& surveyed);

/// Hits across and above the rows (kind "profile"): where the canopy ends.
Result<CanopyProfile> profile_canopy(ScanWork& work, const RowLayout& layout, const GroundModel& ground);

/// The voxel grids of the scan's rows (kind "stretches").
Result<RowSegmentList> cut_row_segments(ScanWork& work, const RowLayout& layout, const GroundModel& ground,
                                        const CanopyProfile& profile, double voxel_m);

}  // namespace rayfield::density
