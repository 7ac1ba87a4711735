#pragma once

#include <memory>

#include "libdensity/scan/scan_stages.h"
#include "libdensity/scan/scan_work.h"
#include "libdensity/voxels/beam_view.h"

namespace rayfield::density {

/// Whether the ground should be asked for the range resolution of a beam: nothing says it, the beam is wide and its
/// first echo is reported (deep spots of the strongest or the last do not lie nearer than their middle).
bool lacks_resolution(const LidarBeam& beam, const BeamOptions& options);

/// view_of() the scan, with its range resolution measured on the ground where neither the options nor the scan say it
/// (kind "spots"; docs/beams.md, "How well").
Result<std::shared_ptr<const BeamView>> view_with_resolution(ScanWork& work, const SurveyedScan& surveyed);

}  // namespace rayfield::density
