#include "rayfield/density/estimator.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace rayfield::density {

Result<Estimator> parse_estimator(std::string_view name) {
  if (name == "unbiased") return Estimator::unbiased;
  if (name == "paper") return Estimator::paper;
  return fail(ErrorCode::usage, "unknown estimator", name, "not one of the known names", "use unbiased or paper");
}

std::string_view estimator_name(Estimator estimator) { return estimator == Estimator::paper ? "paper" : "unbiased"; }

Result<void> EstimatorOptions::validate() const {
  if (!(leaf_size_m2 <= 0.05))
    return fail(ErrorCode::usage, "bad density option", "leaf_size_m2", "must be at most 0.05 m²",
                "give the area of one leaf in m², 0 for none, or leave it to be measured");
  if (paper_min_rays < 1 || paper_min_rays > 1000)
    return fail(ErrorCode::usage, "bad density option", "paper_min_rays", "must lie in 1…1000", "the paper has 10");
  if (!(shared_error >= 0 && shared_error <= 1))
    return fail(ErrorCode::usage, "bad density option", "shared_error", "must lie in 0…1");
  return {};
}

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

double gamma_p(double a, double x) {
  if (!(x > 0)) return 0;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {  // series (Abramowitz & Stegun 6.5.29)
    double term = 1 / a, sum = term;
    for (int n = 1; n < 100000 && term > sum * 1e-17; ++n) sum += term *= x / (a + n);
    return std::min(1.0, sum * front);
  }
  // Continued fraction (6.5.31) by Lentz's method.
  double b = x + 1 - a, c = 1e300, d = 1 / b, f = d;
  for (int n = 1; n < 100000; ++n) {
    const double numerator = -n * (n - a);
    b += 2;
    d = 1 / (numerator * d + b);
    c = b + numerator / c;
    f *= c * d;
    if (std::abs(c * d - 1) < 1e-16) break;
  }
  return std::max(0.0, 1 - front * f);
}

double gamma_p_inverse(double a, double p) {
  if (!(p > 0)) return 0;
  double low = 0, high = std::max(1.0, a);
  while (gamma_p(a, high) < p) low = high, high *= 2;
  for (int step = 0; step < 200 && high - low > 1e-13 * high; ++step) {
    const double middle = (low + high) / 2;
    (gamma_p(a, middle) < p ? low : high) = middle;
  }
  return (low + high) / 2;
}

Interval jeffreys_interval(std::uint64_t hits, double path_m, double level) {
  const double a = static_cast<double>(hits) + 0.5, tail = (1 - level) / 2;
  // χ²(2a; p)/2 is the gamma quantile.
  return {hits == 0 ? 0 : gamma_p_inverse(a, tail) / path_m, gamma_p_inverse(a, 1 - tail) / path_m};
}

}  // namespace rayfield::density
