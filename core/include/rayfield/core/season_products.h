#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "rayfield/core/products.h"

/// What changed in a block from date to date, as plain values: filled by libdensity, written by formats. Areas are
/// one-sided; NaN = not scanned on one of the dates.
namespace rayfield {

/// Whether a panel's change is larger than its errors explain, at 95 %.
enum class ChangeVerdict {
  not_seen,  ///< on one of the dates, so that no change is known
  none,      ///< the interval of the change holds 0
  gain,
  loss
};
constexpr std::string_view verdict_text(ChangeVerdict verdict) {
  switch (verdict) {
    case ChangeVerdict::gain:
      return "gain";
    case ChangeVerdict::loss:
      return "loss";
    case ChangeVerdict::none:
      return "none";
    case ChangeVerdict::not_seen:
      break;
  }
  return "not_seen";
}

/// One panel on two dates, from a to b.
struct PanelChange {
  std::string panel_uid;
  int row_number = 0, panel_number = 0;
  double length_m = 0;
  PanelValue a, b;            ///< as measured; NaN where not seen
  double leaf_change_m2 = 0;  ///< b − a
  double leaf_change_per_m = 0;
  double leaf_change_percent = 0;                          ///< of a; NaN where a is not positive
  double se_change_m2 = 0, ci_low_m2 = 0, ci_high_m2 = 0;  ///< of leaf_change_m2; 95 %
  double p_value = 1;                                      ///< two-sided, that the leaf area did not change
  double plant_change_m2 = 0;
  ChangeVerdict verdict = ChangeVerdict::not_seen;
};

/// Pairs of values of one quantity on two dates.
struct PairedStatistics {
  std::size_t count = 0;
  double mean_a = 0, mean_b = 0;
  double rmse = 0;                                        ///< √ mean (b − a)²
  double rrmse = 0;                                       ///< rmse / mean of all values; NaN where that is not positive
  double slope = 0, intercept = 0;                        ///< least squares of b on a: b ≈ slope·a + intercept
  double orthogonal_slope = 0, orthogonal_intercept = 0;  ///< least squares of the distances to the line
  double r_squared = 0;                                   ///< squared correlation
};

/// All panels together that were seen on both dates.
struct TotalChange {
  double area_a_m2 = 0, area_b_m2 = 0;
  double change_m2 = 0, se_m2 = 0, ci_low_m2 = 0, ci_high_m2 = 0;  ///< 95 %
  ChangeVerdict verdict = ChangeVerdict::not_seen;
};

/// Two dates of a block.
struct DateComparison {
  ScanProduct a, b;
  std::vector<PanelChange> panels;  ///< all of the block, in its order
  std::size_t compared = 0, not_seen = 0, gains = 0, losses = 0;
  TotalChange leaf_total;
  PairedStatistics leaf_per_m, plant_per_m;                        ///< panels, m²/m
  PairedStatistics half_metre_leaf_per_m, half_metre_plant_per_m;  ///< half metres of row, m²/m
};

/// A row, or the block, on one date: the panels that were seen.
struct SeasonValue {
  int row_number = 0;  ///< 0: the whole block
  std::string scan_id, scan_date;
  std::size_t panels = 0, panels_seen = 0;
  double length_m = 0;  ///< of the panels seen
  double leaf_area_m2 = 0, plant_area_m2 = 0;
  double leaf_area_per_m = 0, plant_area_per_m = 0;
  double ci_low_per_m = 0, ci_high_per_m = 0;  ///< 95 % interval of leaf_area_per_m
};

/// A stretch of row with hardly any canopy on one date.
struct RowGap {
  int row_number = 0;
  double start_m = 0, end_m = 0;                       ///< along the row's centreline
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of its middle, map coordinates, m
  int panel_number = 0;                                ///< of the panel that holds its middle; 0: none does
  double length_m() const { return end_m - start_m; }
};

/// Neighbouring panels of a row that are all among the weakest of the block on one date.
struct WeakStretch {
  int row_number = 0;
  int first_panel = 0, last_panel = 0;  ///< panel numbers
  double start_m = 0, end_m = 0;        ///< along the row's centreline
  double leaf_area_per_m = 0;           ///< of all of them together
};

}  // namespace rayfield
