#pragma once

#include <span>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::density {

/// The `classes` intervals with the least sum of squared deviations from their means, weighted; exact but for a
/// rounding of the values to 1/1024 of their range. Returns the bounds between them, rising; a value equal to a bound
/// belongs to the class above. Errors: bad_input, where there are fewer different values than classes.
Result<std::vector<double>> natural_breaks(std::span<const double> values, std::span<const double> weights,
                                           int classes);

}  // namespace rayfield::density
