#pragma once

#include <span>
#include <vector>

#include "libdensity/estimate/row_density.h"
#include "libdensity/layout/row_layout.h"

namespace rayfield::density {

/// A part of a row, by chainage; infinite at the row's ends.
struct RowSpan {
  double from_m = 0, to_m = 0;
};

/// What belongs to each panel: beyond the first and last one what overhangs the row's ends, between two the half that
/// is nearer. `panels`: of one row, ordered along it.
std::vector<RowSpan> panel_spans(std::span<const Panel> panels);
/// Parts of `step_m` from chainage 0; the first and the last take what lies beyond.
std::vector<RowSpan> metre_spans(double row_length_m, double step_m);

/// Share of a voxel column's length (0…1) that lies in the span.
double share_between(const RowDensity& row, int along, const RowSpan& span);

}  // namespace rayfield::density
