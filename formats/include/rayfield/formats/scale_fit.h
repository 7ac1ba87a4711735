#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rayfield/formats/style.h"

namespace rayfield::formats {

/// One colour scale for a product on all dates of a block, fitted to its crop: it ends at the first of 1, 1.5, 2, 3, 5
/// × 10ⁿ that at most 1 % of the canopy's cells exceed on any date, and not below a usual canopy in leaf, so that a
/// season that begins bare begins with the scale of its summer. A later date moves it only by exceeding it. The result
/// depends on the values alone, not on their order, nor on what was exported before.
class ScaleFit {
 public:
  /// `product`: "plan_density", "leaf_density", "plan_density_se", "canopy_height", "ground", "leaf_area_per_m",
  /// "voxel_density", "side_view", "end_on"; others keep the fixed scale of docs/products.md, or that of their data.
  /// Ground: whole metres around all dates.
  explicit ScaleFit(std::string_view product);

  /// Values of one date, in any number of calls; NaN is left out, and so are values too low for canopy.
  void add(std::span<const float> values);
  void add(double value);
  /// Ends the date.
  void end_date();

  /// Of the dates that were ended.
  ColorScale scale() const;

 private:
  std::string product_;
  std::vector<double> ends_;           ///< that the scale may have; empty: it is not fitted
  std::vector<std::uint64_t> counts_;  ///< of the date's values up to each end, the last: of those above all
  std::size_t end_ = 0;                ///< of the dates so far
  double low_, high_;                  ///< of all values
};

}  // namespace rayfield::formats
