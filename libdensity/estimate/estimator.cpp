#include "rayfield/density/estimator.h"

#include <algorithm>

namespace rayfield::density {

double unbiased_rate(double hits, double path, double hit_path) {
  return path > 0 ? std::max(0.0, hits / path - hit_path / (path * path)) : 0;
}

PaperEstimate estimate_paper(std::uint64_t rays, std::uint64_t hits, double path_m) {
  PaperEstimate out;
  out.observed = rays >= 1 && path_m > 0;
  if (!out.observed) return out;
  const auto n = static_cast<double>(rays), m = static_cast<double>(hits);
  out.density = 2 * (n - 1) / n * m / path_m;
  out.variance = 4 * m / (path_m * path_m);
  return out;
}

}  // namespace rayfield::density
