#pragma once

#include <algorithm>
#include <array>

namespace rayfield::slam {

/// Weights of the four knots that act at one time.
struct SplineWeights {
  int first = 0;  ///< knots first … first+3
  std::array<double, 4> value{};
};

/// A uniform cubic B-spline in time: knot coefficients c_j at spacing h; with u = (t − start)/h, i = ⌊u⌋, f = u − i
///   x(t) = [(1−f)³ c_i + (3f³−6f²+4) c_{i+1} + (−3f³+3f²+3f+1) c_{i+2} + f³ c_{i+3}] / 6.
/// C² everywhere; zero coefficients at three neighbouring knots make value, slope and curvature zero between them.
struct CorrectionSpline {
  double start_s = 0;
  double step_s = 0.2;
  int spans = 1;

  int knots() const { return spans + 3; }

  SplineWeights weights(double time_s) const {
    const double u = std::clamp((time_s - start_s) / step_s, 0.0, static_cast<double>(spans));
    const int i = std::min(static_cast<int>(u), spans - 1);
    const double f = u - i, g = 1 - f;
    return {i,
            {g * g * g / 6, (3 * f * f * f - 6 * f * f + 4) / 6, (-3 * f * f * f + 3 * f * f + 3 * f + 1) / 6,
             f * f * f / 6}};
  }
};

}  // namespace rayfield::slam
