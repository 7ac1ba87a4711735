#pragma once

#include <vector>

#include "libalign/evidence/evidence.h"

namespace rayfield::align {

struct Hypothesis {
  PlanShift pose;
  Evidence evidence;
};

/// Everything that the scan could be taken for, the most likely first: shifts that lay one of its uprights on one of
/// the reference's with their rows along each other, also turned by half a turn, that bring many others together.
/// Each is fitted and weighed; what ends at the same place is one.
std::vector<Hypothesis> find_hypotheses(const LandmarkPair& pair, const SearchOptions& options);

}  // namespace rayfield::align
