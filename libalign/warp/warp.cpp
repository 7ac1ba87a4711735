#include "rayfield/align/warp.h"

#include <algorithm>

namespace rayfield::align {
namespace {

// Uniform cubic B-spline: the span and the four basis values at a coordinate counted in spans.
int basis(double u, int spans, double* weights) {
  const double inside = std::clamp(u, 0.0, static_cast<double>(spans));
  const int span = std::min(spans - 1, static_cast<int>(inside));
  const double t = inside - span, t2 = t * t, t3 = t2 * t;
  weights[0] = (1 - 3 * t + 3 * t2 - t3) / 6;
  weights[1] = (4 - 6 * t2 + 3 * t3) / 6;
  weights[2] = (1 + 3 * t + 3 * t2 - 3 * t3) / 6;
  weights[3] = t3 / 6;
  return span;
}

}  // namespace

WarpWeights warp_weights(const Warp& warp, const Eigen::Vector2d& p) {
  const Eigen::Vector2d u = (p - warp.origin) / warp.spacing_m;
  WarpWeights weights;
  weights.first_x = basis(u.x(), warp.nx - 3, weights.x);
  weights.first_y = basis(u.y(), warp.ny - 3, weights.y);
  return weights;
}

Eigen::Vector3d Warp::at(const Eigen::Vector2d& p) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (empty()) return sum;
  const WarpWeights w = warp_weights(*this, p);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum += w.x[i] * w.y[j] * control[static_cast<std::size_t>((w.first_y + j) * nx + w.first_x + i)];
  return sum;
}

}  // namespace rayfield::align
