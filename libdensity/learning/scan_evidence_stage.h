#pragma once

#include "libdensity/layout/row_layout.h"
#include "libdensity/learning/scan_evidence.h"
#include "libdensity/scan/scan_stages.h"

namespace rayfield::density {

/// What the scan shows of the rows of `known`, and rows beside them (kind "stems"). Depends on where the known rows run
/// and on nothing else that the registry says, so that what other scans teach does not make it anew.
Result<ScanEvidence> gather_evidence(ScanWork& work, const SurveyedScan& surveyed, const RowLayout& known);

/// Adds to a key where the known rows run.
void add_lines(KeyBuilder& key, const RowLayout& known);

}  // namespace rayfield::density
