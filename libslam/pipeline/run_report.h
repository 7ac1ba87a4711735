#pragma once

#include "libslam/pipeline/run_facts.h"
#include "rayfield/slam/slam.h"

namespace rayfield::slam {

/// The report of a run; marks GPS outliers in `result`.
SlamReport make_report(const RunFacts& facts, SlamResult& result);

}  // namespace rayfield::slam
