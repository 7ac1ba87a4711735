#pragma once

#include <algorithm>
#include <cmath>

namespace rayfield::density {

inline constexpr double kNormal95 = 1.959963984540054;  ///< 97.5 % quantile of the normal distribution

/// How far a 95 % interval reaches below and above a value, both ≥ 0.
struct Reach {
  double below = 0, above = 0;
};

/// Of an area A whose sampling has the variance s² (m⁴) and which may besides be off by a factor whose logarithm has
/// the standard error e, the same for all of it:
///   below: √((1.96·s)² + (A·(1 − exp(−1.96·e)))²), above: √((1.96·s)² + (A·(exp(1.96·e) − 1))²).
/// ± 1.96·√(s² + (e·A)²) where e is small. Where it is not, an area read at half of the truth is as likely as one read
/// at twice of it, so that the interval reaches further up than down.
inline Reach reach_of(double area_m2, double variance_m4, double shared_error) {
  const double area = std::abs(area_m2), sampling = kNormal95 * std::sqrt(std::max(0.0, variance_m4));
  return {std::hypot(sampling, area * -std::expm1(-kNormal95 * shared_error)),
          std::hypot(sampling, area * std::expm1(kNormal95 * shared_error))};
}

}  // namespace rayfield::density
