#include "rayfield/core/beam_spot.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "rayfield/core/lidar_beam.h"

namespace rayfield {
namespace {

constexpr double kLiftSigma_m = 0.003;  // of one lift
constexpr double kMaxDeviations = 3;    // beyond, lifts cost no more: relief, grass
constexpr std::size_t kSections = 8;
constexpr double kStep = 1.03;  // from one resolution that is tried to the next
constexpr int kSteps = 156;     // down to 1 cm

// Mean deviation of the lifts from those that a resolution predicts, in standard deviations; far-off ones count as
// kMaxDeviations.
double misfit(std::span<const SpotLift> lifts, double resolution_m) {
  double sum = 0;
  for (const SpotLift& p : lifts) {
    const double predicted = p.cos_incidence * spot_shift_m(p.spot_depth_m, resolution_m);
    sum += std::min(kMaxDeviations, std::abs(p.lift_m - predicted) / kLiftSigma_m);
  }
  return sum / static_cast<double>(lifts.size());
}

// The resolution of least misfit, to 3 %.
double best_resolution(std::span<const SpotLift> lifts) {
  double best = kMaxRangeResolution_m, least = misfit(lifts, best);
  for (int k = 1; k < kSteps; ++k) {
    const double b = kMaxRangeResolution_m * std::pow(kStep, -k);
    const double m = misfit(lifts, b);
    if (m < least) least = m, best = b;
  }
  return best;
}

}  // namespace

// Depths in units of half the spot's, from −1 at the near edge: the disc has the energy 2·√(1 − x²) dx there. Up to the
// depth c its energy is acos(−c) + c·√(1 − c²), and the mean depth −(2/3)·(1 − c²)^(3/2) over that.
double spot_shift_m(double spot_depth_m, double resolution_m) {
  if (resolution_m >= spot_depth_m) return 0;
  const double c = 2 * resolution_m / spot_depth_m - 1, s = std::sqrt(std::max(0.0, 1 - c * c));
  const double energy = std::acos(-c) + c * s;
  if (energy < 1e-9) return 0.5 * spot_depth_m;
  return 0.5 * spot_depth_m * (2.0 / 3) * s * s * s / energy;
}

RangeResolution fit_range_resolution(std::span<const SpotLift> lifts) {
  RangeResolution out;
  out.pairs = lifts.size();
  out.value_m = best_resolution(lifts);
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < kSections; ++k) {
    const std::size_t begin = k * lifts.size() / kSections, end = (k + 1) * lifts.size() / kSections;
    const double b = best_resolution(lifts.subspan(begin, end - begin));
    sum += b, squares += b * b;
  }
  const double mean = sum / kSections;
  out.sigma_m = std::sqrt(std::max(0.0, squares / kSections - mean * mean) / (kSections - 1));
  return out;
}

std::optional<RangeResolution> believed(const RangeResolution& fit, double unnoticed_m, double max_relative_sigma) {
  if (fit.value_m >= kMaxRangeResolution_m || fit.sigma_m > max_relative_sigma * fit.value_m) return std::nullopt;
  RangeResolution out = fit;
  out.value_m = std::max(kFinestRange_m, out.value_m - unnoticed_m);
  return out;
}

}  // namespace rayfield
