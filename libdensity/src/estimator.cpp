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
  if (!(leaf_area_m2 <= 0.05))
    return fail(ErrorCode::usage, "bad density option", "leaf_area_m2", "must be at most 0.05 m²",
                "give the area of one leaf in m², 0 for none, or leave it to be measured");
  if (paper_min_rays < 1 || paper_min_rays > 1000)
    return fail(ErrorCode::usage, "bad density option", "paper_min_rays", "must lie in 1…1000", "the paper has 10");
  if (!(shared_error >= 0 && shared_error <= 1))
    return fail(ErrorCode::usage, "bad density option", "shared_error", "must lie in 0…1");
  return {};
}

LeafCorrection LeafCorrection::of(double leaf_area_m2, double voxel_m) {
  if (!(leaf_area_m2 > 0)) return {};
  return {leaf_area_m2, effective_element_area(leaf_area_m2, voxel_m)};
}

VoxelEstimate estimate_voxel(const VoxelCounters& c, double voxel_m, const LeafCorrection& leaf) {
  VoxelEstimate out;
  out.observed = c.rays >= 2 && c.path > 0;
  if (!out.observed || c.hits == 0) return out;
  constexpr double unit = VoxelCounters::kUnit;
  // Everything in units of the voxel's side; λ₁ then is ½·area/side².
  const double l1 = 0.5 * leaf.effective_area_m2 / (voxel_m * voxel_m);
  const auto effective = [l1](std::int64_t u1, std::int64_t u2, std::int64_t u3) {
    return unit * (static_cast<double>(u1) + l1 / 2 * static_cast<double>(u2) + l1 * l1 / 3 * static_cast<double>(u3));
  };
  const double s = effective(c.path, c.path2, c.path3), h = effective(c.hit_path, c.hit_path2, c.hit_path3);
  const double rate = std::max(0.0, c.hits / s - h / (s * s));
  out.density = 2 * rate / voxel_m;
  const double rate_variance = c.hits / (s * s) + rate * 0.5 * leaf.area_m2 / (voxel_m * voxel_m);
  out.variance = 4 * rate_variance / (voxel_m * voxel_m);
  return out;
}

VoxelEstimate estimate_paper(std::uint64_t rays, std::uint64_t hits, double path_m) {
  VoxelEstimate out;
  out.observed = rays >= 1 && path_m > 0;
  if (!out.observed) return out;
  const auto n = static_cast<double>(rays), m = static_cast<double>(hits);
  out.density = 2 * (n - 1) / n * m / path_m;
  out.variance = 4 * m / (path_m * path_m);
  return out;
}

double estimate_weighted(const WeightedRay* rays, std::size_t count) {
  double s = 0, hits = 0, h = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const WeightedRay& r = rays[i];
    s += r.weight * r.projection * r.path_m;
    if (!r.hit) continue;
    hits += r.weight;
    h += r.weight * r.weight * r.projection * r.path_m;
  }
  return s > 0 ? hits / s - h / (s * s) : 0;
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
