#pragma once

#include <cstdint>
#include <string_view>

#include "rayfield/core/result.h"
#include "rayfield/density/voxel_grid.h"

/// From counts to leaf area density (method, section 6; derivations in docs/density.md).
namespace rayfield::density {

enum class Estimator {
  unbiased,  ///< λ̂ = m/S − H/S² over slabs of nine voxels, finite leaves corrected
  paper      ///< (n−1)/n·m/S with neighbours borrowed until n ≥ 10: the published method
};
/// "unbiased", "paper". Errors: usage.
Result<Estimator> parse_estimator(std::string_view name);
std::string_view estimator_name(Estimator estimator);

struct EstimatorOptions {
  Estimator estimator = Estimator::unbiased;
  /// Area of one leaf, m²; 0 = none (infinitesimal leaves), negative = measured from the scan (estimate_leaf_size).
  /// A third too large lowers the density of a typical canopy by 1 %, by 2 % with voxels fitted to it. Valid: < 0, or
  /// 0…0.05.
  double leaf_size_m2 = -1;
  std::uint32_t paper_min_rays = 10;  ///< `paper` borrows until a voxel has that many rays. Valid: 1…1000
  /// Relative standard error that all voxels of a panel share (leaf angles, clumping below the voxel size), in the
  /// intervals only. The default is the spread of the ratio to truth over simulated canopies of different kinds.
  double shared_error = 0.025;
  Result<void> validate() const;
};

/// λ̂ per voxel side from Σ w·m, Σ w·S and Σ w²·H over rays or voxels with fixed weights w (m hits, S
/// spherical-equivalent path in voxel sides, H that of the rays that hit): m/S − H/S². Density = 2·λ̂ / voxel side.
/// Unbiased for leaves that are a Poisson process along every ray, for two rays or more; 0 without path. See
/// docs/density.md.
double unbiased_rate(double hits, double path, double hit_path);

struct PaperEstimate {
  double density = 0;   ///< one-sided area per volume, m²/m³
  double variance = 0;  ///< of density, (m²/m³)²
  bool observed = false;
};
/// m/S·(n−1)/n, density = 2·λ̂, from pooled sums: rays, hits and Σ of spherical-equivalent paths (m).
PaperEstimate estimate_paper(std::uint64_t rays, std::uint64_t hits, double path_m);

struct Interval {
  double low = 0, high = 0;
};
/// Jeffreys interval of a Poisson rate: χ²(2m+1)/(2·path) at (1∓level)/2; the lower end is 0 when there was no hit.
/// For the density multiply by 2. `path_m` > 0, 0 < level < 1.
Interval jeffreys_interval(std::uint64_t hits, double path_m, double level = 0.95);

/// Regularised lower incomplete gamma function P(a, x) and its inverse in x; a > 0, 0 ≤ p < 1. Relative error < 1e-10.
double gamma_p(double a, double x);
double gamma_p_inverse(double a, double p);

}  // namespace rayfield::density
