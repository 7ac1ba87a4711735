#pragma once

#include <span>

#include "libdensity/estimate/row_density.h"
#include "libdensity/estimate/voxel_sums.h"

namespace rayfield::density {

/// Potential path (Σ of what the rays would have crossed without their hits, in voxel sides) from which a slab speaks
/// for itself. With less λ̂ is still unbiased, but of unbounded variance: two rays that both end on entering say
/// "infinitely dense". The potential path depends on where the rays go and not on what they meet in the voxels, so that
/// the choice does not bias what is kept. Less path: see pool_and_fill() in row_fill.h.
inline constexpr double kMinPotential = 3.0;

/// Variance of the area that a leaf shows to rays of one direction, over the square of its mean: it goes with the
/// cosine c to the leaf's normal, which is evenly spread between 0 and 1 over leaves turned at random, E[c²]/E[c]² − 1.
inline constexpr double kLeafTurnVariance = 1.0 / 3;

/// Density, variance and state of every voxel (docs/density.md, "Slabs"). The slab of a voxel is the voxel and its
/// eight neighbours in the plane along the row and upwards; across the row, where light is lost, it is one voxel thick.
/// With P the potential path of a voxel, P̄ its mean over the N voxels of the slab around it, S path, H hit path, m
/// hits, b and s the shadows of leaves in front of the voxel and inside it (leaf_shadow):
///   w = 1/(P + P̄),  D = Σ_slab w·S·(1 + b·w·P) + s·Σ_slab w·P/N,  λ̂ = Σ_slab w·m/D − Σ_slab w²·H/D² (unbiased_rate).
/// The sum of λ̂ over all slabs is shared out to the voxels with the hits: a voxel gets w·m·Σ1/D − w²·H·Σ1/D², sums
/// over the slabs that it is part of, so that what is empty stays empty. Voxels with fewer than two rays get the λ̂ of
/// their own slab (state filled). Where a slab has less potential path than kMinPotential, its voxel is `pooled` (two
/// rays or more) or `unobserved`, and pool_and_fill() adds to what the slabs around have given it.
/// Variance: hits are Poisson events, and the rays of a leaf all see it under the same angle
/// (density·kLeafTurnVariance·leaf area / volume).
void estimate_slabs(RowDensity& row, std::span<const VoxelSums> sums);

}  // namespace rayfield::density
