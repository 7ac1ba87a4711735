#pragma once

#include <vector>

#include "rayfield/formats/report.h"

namespace rayfield::formats {

/// One scale for all dates, fitted to the block: 98 % of what there is lies below its end, which is a round number.
/// What lies above takes the end colour.
struct ReportScales {
  double leaf = 1;    ///< leaf area per metre of row of panels, m²/m
  double map = 1;     ///< plan density where there is canopy, m²/m²
  double side = 1;    ///< side views where there is canopy, m²/m²
  double change = 1;  ///< amount of change per metre between dates that follow each other, m²/m
};
ReportScales report_scales(const BlockReport& report);

/// The smallest of 1, 1.5, 2, 3, 4, 5, 6, 8 × 10ⁿ that is not below the 98 % quantile of the positive values; 1 where
/// there are none.
double scale_end(std::vector<float> values);

}  // namespace rayfield::formats
