#pragma once

#include <cmath>
#include <cstdint>

namespace rayfield::density {

/// Lengths as integers of 0.1 mm (the resolution of the store), so that sums do not depend on their order.
constexpr double kFixedPerMetre = 1e4;

inline std::int64_t fixed_from_metres(double metres) { return std::llround(metres * kFixedPerMetre); }
inline double metres_from_fixed(std::int64_t units) { return static_cast<double>(units) / kFixedPerMetre; }

/// Quotient rounded towards minus infinity; `divisor` > 0.
inline std::int64_t floor_div(std::int64_t value, std::int64_t divisor) {
  const std::int64_t q = value / divisor;
  return q - ((value % divisor) < 0 ? 1 : 0);
}

}  // namespace rayfield::density
