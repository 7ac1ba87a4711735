#pragma once

#include "libdensity/layout/row_layout.h"
#include "libdensity/scan/scan_stages.h"

namespace rayfield::density {

/// A surveyed layout completed by what a scan shows of it: rows run where they were surveyed; which sides were driven
/// along, trunks, and the posts' radii, heights and leans come from the scan. A surveyed post is where the scan shows
/// it if that is within 0.15 m; panels end where the survey has the post. Rows without surveyed posts get those found
/// in the scan. Errors: bad_input, when the scan does not reach the surveyed rows.
Result<FoundLayout> complete_survey(ScanWork& work, const SurveyedScan& surveyed, const RowLayout& survey);

}  // namespace rayfield::density
