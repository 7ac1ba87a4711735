#pragma once

#include "libdensity/echoes/echo_statistics.h"
#include "libdensity/scan/scan_stages.h"
#include "libdensity/scan/scan_work.h"
#include "rayfield/core/lidar_beam.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// Whether the ground tells the range resolution of a beam: it is wide, its first echo is reported (deep spots of the
/// strongest or the last do not lie nearer than their middle), and it goes all round, so that the ground is met
/// steeply, too.
bool ground_tells_resolution(const LidarBeam& beam, bool one_beam);

/// The range resolution of the scan's beam, as the options, the rig or SLAM say it; else from echoes of leaves, where
/// they tell it to 2 cm; else from the ground (kind "spots"; docs/beams.md, "How it is taken out"); else what echoes
/// and what is usual make likely.
Result<BelievedResolution> range_resolution_of_scan(ScanWork& work, const SurveyedScan& surveyed,
                                                    const EchoStatistics& statistics);

/// Whether it is known so well that areas do not suffer: to 2 cm.
bool is_known(const BelievedResolution& resolution);

}  // namespace rayfield::density
