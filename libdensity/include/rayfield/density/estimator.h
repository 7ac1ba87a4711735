#pragma once

#include <cstdint>

/// The estimators of density, from sums over rays.
namespace rayfield::density {

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

}  // namespace rayfield::density
