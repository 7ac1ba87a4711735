#include "libdensity/estimate/slab_density.h"

#include <algorithm>
#include <vector>

namespace rayfield::density {
namespace {

/// Calls visit(voxel) for the voxels of the slab around (along, across, up) that lie in the grid.
template <class Visit>
void for_slab(const RowDensity& r, int along, int across, int up, Visit visit) {
  for (int a = std::max(0, along - 1); a <= std::min(r.n_along - 1, along + 1); ++a)
    for (int u = std::max(0, up - 1); u <= std::min(r.n_up - 1, up + 1); ++u) visit(r.index(a, across, u));
}

template <class Visit>
void for_voxels(const RowDensity& r, Visit visit) {
  for (int a = 0; a < r.n_along; ++a)
    for (int c = 0; c < r.n_across; ++c)
      for (int u = 0; u < r.n_up; ++u) visit(a, c, u, r.index(a, c, u));
}

/// w = 1/(P + P̄); 0 where the slab has no rays.
std::vector<double> weights_of(const RowDensity& r, std::span<const VoxelSums> sums) {
  std::vector<double> out(sums.size(), 0);
  for_voxels(r, [&](int a, int c, int u, std::size_t voxel) {
    double sum = 0, count = 0;
    for_slab(r, a, c, u, [&](std::size_t i) { sum += sums[i].potential, count += 1; });
    if (sum > 0) out[voxel] = 1 / (sums[voxel].potential + sum / count);
  });
  return out;
}

/// Sums over one slab, weighted.
struct Slab {
  double potential = 0;  ///< ΣP, not weighted
  double hits = 0, path = 0, hit_path = 0;
  double hits_squared = 0;  ///< Σ w²·m: variance of Σ w·m
};

Slab slab_at(const RowDensity& r, std::span<const VoxelSums> sums, const std::vector<double>& weight,
             const LeafShadow& shadow, int along, int across, int up) {
  Slab out;
  double lit = 0, count = 0;  // Σ w·P, N
  for_slab(r, along, across, up, [&](std::size_t i) {
    const VoxelSums& v = sums[i];
    const double w = weight[i];
    out.potential += v.potential;
    out.path += w * v.path * (1 + shadow.in_front * w * v.potential);
    lit += w * v.potential, count += 1;
    out.hits += w * v.hits, out.hits_squared += w * w * v.hits_squared;
    out.hit_path += w * w * v.hit_path;
  });
  out.path += shadow.inside * lit / count;
  return out;
}

}  // namespace

void estimate_slabs(RowDensity& r, std::span<const VoxelSums> sums) {
  const LeafShadow shadow = leaf_shadow(r.leaf_size_m2, r.voxel_m);
  const double to_density = 2 / r.voxel_m, to_variance = to_density * to_density;
  const double turned_leaves = kLeafTurnVariance * 0.5 * r.leaf_size_m2 / (r.voxel_m * r.voxel_m);
  const std::vector<double> weight = weights_of(r, sums);
  std::vector<double> inverse(sums.size(), 0);  // 1/D of the slabs that are shared out
  for_voxels(r, [&](int a, int c, int u, std::size_t voxel) {
    const Slab slab = slab_at(r, sums, weight, shadow, a, c, u);
    const bool seen = sums[voxel].rays >= 2, enough = slab.potential >= kMinPotential && slab.path > 0;
    r.state[voxel] = seen ? (enough ? VoxelState::observed : VoxelState::pooled)
                          : (enough ? VoxelState::filled : VoxelState::unobserved);
    if (!enough) return;
    if (seen) {
      inverse[voxel] = 1 / slab.path;
    } else {
      r.density[voxel] = static_cast<float>(to_density * unbiased_rate(slab.hits, slab.path, slab.hit_path));
      r.variance[voxel] = static_cast<float>(to_variance * slab.hits_squared / (slab.path * slab.path));
    }
  });
  for_voxels(r, [&](int a, int c, int u, std::size_t voxel) {
    const VoxelSums& v = sums[voxel];
    if (v.hits == 0) return;
    double sum = 0, squares = 0;
    for_slab(r, a, c, u, [&](std::size_t i) { sum += inverse[i], squares += inverse[i] * inverse[i]; });
    const double w = weight[voxel];
    const double rate = w * v.hits * sum - w * w * v.hit_path * squares;
    r.density[voxel] += static_cast<float>(to_density * rate);
    r.variance[voxel] += static_cast<float>(to_variance * (w * w * v.hits_squared * sum * sum + rate * turned_leaves));
  });
}

}  // namespace rayfield::density
