#pragma once

#include <cstdint>
#include <string_view>

#include "rayfield/core/result.h"
#include "rayfield/density/voxel_grid.h"

/// From counts to leaf area density (method, section 6; derivations in docs/density.md).
namespace rayfield::density {

enum class Estimator {
  unbiased,  ///< λ̂ = m/S − H/S², finite leaves corrected
  paper      ///< (n−1)/n·m/S with neighbours borrowed until n ≥ 10: the published method
};
/// "unbiased", "paper". Errors: usage.
Result<Estimator> parse_estimator(std::string_view name);
std::string_view estimator_name(Estimator estimator);

struct EstimatorOptions {
  Estimator estimator = Estimator::unbiased;
  /// Area of one leaf, m²; 0 = none (infinitesimal leaves), negative = measured from the scan (estimate_element_size).
  /// A third too large lowers the density of a typical canopy by about 2 %. Valid: < 0, or 0…0.05.
  double leaf_area_m2 = -1;
  std::uint32_t paper_min_rays = 10;  ///< `paper` borrows until a voxel has that many rays. Valid: 1…1000
  /// Relative standard error that all voxels of a panel share (leaf angles, clumping below the voxel size), in the
  /// intervals only. The default is the spread of the ratio to truth over simulated canopies of different kinds.
  double shared_error = 0.025;
  Result<void> validate() const;
};

/// The two constants of the finite-leaf correction for one voxel size.
struct LeafCorrection {
  double area_m2 = 0;            ///< of one leaf; enters the variance
  double effective_area_m2 = 0;  ///< effective_element_area(); enters the mean
  static LeafCorrection of(double leaf_area_m2, double voxel_m);
};

struct VoxelEstimate {
  double density = 0;     ///< one-sided area per volume, m²/m³
  double variance = 0;    ///< of density, (m²/m³)²
  bool observed = false;  ///< at least two rays
};

/// Potential path (Σ of what the rays would have crossed without their hits, in voxel sides) from which a voxel speaks
/// for itself. With fewer rays λ̂ is still unbiased, but of unbounded variance: two rays that both end on entering say
/// "infinitely dense". The potential path depends on where the rays go and not on what they meet in the voxel, so that
/// the choice does not bias what is kept. Less path: see pool_and_fill() in docs/density.md.
inline constexpr double kMinPotential = 3.0;

/// One voxel on its own. With u the spherical-equivalent paths (VoxelCounters), S and H sums of the effective paths
/// u + λ₁u²/2 + λ₁²u³/3 (Pimont et al. 2018, third order), λ₁ = ½·effective leaf area / voxel volume per metre:
///   λ̂ = m/S − H/S², density = 2·λ̂.  Unbiased for Poisson leaves when n ≥ 2.
/// Variance of λ̂: m/S² + λ̂·½·leaf area / volume: rays are Poisson events, and the leaves behind them come whole.
/// The value is given whatever the potential path.
VoxelEstimate estimate_voxel(const VoxelCounters& counters, double voxel_m, const LeafCorrection& leaf);

/// m/S·(n−1)/n, density = 2·λ̂, from pooled sums: rays, hits and Σ of spherical-equivalent paths (m).
VoxelEstimate estimate_paper(std::uint64_t rays, std::uint64_t hits, double path_m);

/// λ̂ for rays with weights w_i and projections G_i, as area per volume: Σ_hit w/S − Σ_hit w²·G·x/S², S = Σ w·G·x.
struct WeightedRay {
  double path_m;      ///< x: free path in the voxel
  double projection;  ///< G
  double weight;      ///< w
  bool hit;
};
double estimate_weighted(const WeightedRay* rays, std::size_t count);

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
