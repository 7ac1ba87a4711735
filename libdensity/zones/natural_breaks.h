#pragma once

#include <span>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::density {

struct NaturalBreaks {
  std::vector<double> breaks;  ///< rising; a value equal to a break belongs to the class above
  double explained = 0;        ///< 1 − variance inside classes / variance: Jenks' goodness of variance fit
};

/// The `classes` intervals with the least sum of squared deviations from their means, weighted; exact but for a
/// rounding of the values to 1/1024 of their range. Errors: bad_input, where there are fewer different values than
/// classes.
Result<NaturalBreaks> natural_breaks(std::span<const double> values, std::span<const double> weights, int classes);

}  // namespace rayfield::density
