#include "libdensity/estimate/row_fill.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace rayfield::density {
namespace {

constexpr int kDepths = 12;  // deeper voxels count as this deep
constexpr int kLayers = 2;   // donors at most so many layers higher or lower
constexpr double kMinDonors = 4;
constexpr double kMinPooled = 12;                // voxel sides of potential path in a pool
constexpr int kFirstReach = 4, kLastReach = 64;  // columns along the row
constexpr int kNearReach = 3;                    // voxels; nearest seen voxels are looked for so far away
constexpr double kMinNear = 9;
constexpr int kMaxBorrow = 6;

/// Over voxels that speak for themselves: number, density and its square. Over the others: their rays, in voxel sides.
struct Sum {
  double count = 0, density = 0, square = 0;
  double potential = 0, hits = 0, path = 0, hit_path = 0;

  void add(const Sum& o, double sign) {
    count += sign * o.count, density += sign * o.density, square += sign * o.square;
    potential += sign * o.potential, hits += sign * o.hits, path += sign * o.path, hit_path += sign * o.hit_path;
  }
};

/// Depth of each voxel of one cross-section, [across·n_up + up]; 0 = seen and empty. Two chamfer passes are exact for
/// the chessboard distance; beyond the section everything is outside.
std::vector<int> section_depth(const RowDensity& r, int along) {
  const int nc = r.n_across, nu = r.n_up;
  const Shape3 section{1, nc, nu};
  std::vector<int> depth(section.size());
  const auto at = [&](int c, int u) { return section.index(0, c, u); };
  const auto value = [&](int c, int u) { return c < 0 || u < 0 || c >= nc || u >= nu ? 0 : depth[at(c, u)]; };
  for (int c = 0; c < nc; ++c)
    for (int u = 0; u < nu; ++u) {
      const std::size_t i = r.index(along, c, u);
      depth[at(c, u)] = r.state[i] == VoxelState::observed && r.density[i] == 0 ? 0 : nc + nu;
    }
  for (int c = 0; c < nc; ++c)
    for (int u = 0; u < nu; ++u)
      depth[at(c, u)] = std::min(
          depth[at(c, u)], 1 + std::min({value(c - 1, u - 1), value(c - 1, u), value(c - 1, u + 1), value(c, u - 1)}));
  for (int c = nc - 1; c >= 0; --c)
    for (int u = nu - 1; u >= 0; --u)
      depth[at(c, u)] = std::min(
          {depth[at(c, u)], 1 + std::min({value(c + 1, u - 1), value(c + 1, u), value(c + 1, u + 1), value(c, u + 1)}),
           kDepths});
  for (int& d : depth) d = std::min(d, kDepths);
  // A voxel that was seen empty keeps 0 through both passes, since 1 + anything ≥ 1.
  return depth;
}

/// Running sums along the row of observed voxels by depth and layer: a window is a difference of two.
class Donors {
 public:
  explicit Donors(const RowDensity& r)
      : layers_(r.n_up), along_(r.n_along), sums_(Shape3{r.n_along + 1, kDepths + 1, r.n_up}) {}

  void set_section(const RowDensity& r, std::span<const VoxelSums> sums, int along, const std::vector<int>& depth) {
    for (int d = 0; d <= kDepths; ++d)
      for (int u = 0; u < layers_; ++u) at(along + 1, d, u) = at(along, d, u);
    std::size_t i = 0;
    for (int c = 0; c < r.n_across; ++c)
      for (int u = 0; u < layers_; ++u, ++i) {
        const std::size_t voxel = r.index(along, c, u);
        Sum& sum = at(along + 1, depth[i], u);
        if (r.state[voxel] == VoxelState::observed) {
          const auto density = static_cast<double>(r.density[voxel]);
          sum.count += 1, sum.density += density, sum.square += density * density;
        } else {
          const VoxelSums& v = sums[voxel];
          sum.potential += v.potential, sum.hits += v.hits;
          sum.path += v.path, sum.hit_path += v.hit_path;
        }
      }
  }
  Sum window(int along, int reach, int depth, int up) const {
    const int from = std::max(0, along - reach), to = std::min(along_, along + reach + 1);
    Sum out;
    for (int u = std::max(0, up - kLayers); u <= std::min(layers_ - 1, up + kLayers); ++u) {
      out.add(at(to, depth, u), 1), out.add(at(from, depth, u), -1);
    }
    return out;
  }

 private:
  Sum& at(int along, int depth, int up) { return sums_.at(along, depth, up); }
  const Sum& at(int along, int depth, int up) const { return sums_.at(along, depth, up); }

  int layers_, along_;
  Grid3<Sum> sums_;
};

/// Seen voxels within a cube: how many, how many of them empty, and their densities.
struct Around {
  double seen = 0, empty = 0, density = 0, square = 0;
};

Around around(const RowDensity& r, int a, int c, int u, int reach) {
  Around out;
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -reach; k <= reach; ++k) {
        if (!r.shape().contains(a + i, c + j, u + k)) continue;
        const std::size_t voxel = r.index(a + i, c + j, u + k);
        if (!r.seen(voxel)) continue;
        const auto density = static_cast<double>(r.density[voxel]);
        out.seen += 1, out.empty += density == 0 ? 1 : 0;
        out.density += density, out.square += density * density;
      }
  return out;
}

/// To what the slabs around have given the voxel for its hits.
void add(RowDensity& r, std::size_t voxel, double density, double variance) {
  r.density[voxel] += static_cast<float>(density), r.variance[voxel] += static_cast<float>(variance);
}

/// λ̂ over the pool of badly seen voxels; false where the pool is too small.
bool take_pool(RowDensity& r, const Donors& donors, int a, int u, int depth, std::size_t voxel) {
  for (int reach = kFirstReach; reach <= kLastReach; reach *= 2) {
    const Sum pool = donors.window(a, reach, depth, u);
    if (pool.potential < kMinPooled || !(pool.path > 0)) continue;
    const double density = 2 * unbiased_rate(pool.hits, pool.path, pool.hit_path) / r.voxel_m;
    // The value of one voxel among the pool: as uncertain as its kind is varied, taken as its own size.
    add(r, voxel, density, density * density);
    return true;
  }
  return false;
}

bool take_mean(RowDensity& r, const Donors& donors, int a, int u, int depth, std::size_t voxel) {
  for (int reach = kFirstReach; reach <= kLastReach; reach *= 2) {
    const Sum sum = donors.window(a, reach, depth, u);
    if (sum.count < kMinDonors) continue;
    const double mean = sum.density / sum.count;
    add(r, voxel, mean, std::max(0.0, sum.square / sum.count - mean * mean));
    return true;
  }
  return false;
}

/// Inside dense canopy (few of the seen neighbours are empty) what others as badly seen at that depth say; elsewhere,
/// thin or outside the canopy, the mean of the nearest seen voxels, the empty ones with them; at last the mean at the
/// depth, or at the deepest that was seen.
void fill_voxel(RowDensity& r, const Donors& donors, int a, int c, int u, int depth) {
  const std::size_t voxel = r.index(a, c, u);
  const Around next = around(r, a, c, u, 1);
  bool done = 4 * next.empty <= next.seen && take_pool(r, donors, a, u, depth, voxel);
  for (int reach = 1; !done && reach <= kNearReach; ++reach) {
    const Around near = reach == 1 ? next : around(r, a, c, u, reach);
    if (near.seen < kMinNear) continue;
    const double mean = near.density / near.seen;
    add(r, voxel, mean, std::max(0.0, near.square / near.seen - mean * mean));
    done = true;
  }
  for (int d = depth; !done && d >= 1; --d)
    done = take_pool(r, donors, a, u, d, voxel) || take_mean(r, donors, a, u, d, voxel);
  if (done) r.state[voxel] = VoxelState::filled;
}

}  // namespace

void pool_and_fill(RowDensity& row, std::span<const VoxelSums> sums) {
  Donors donors(row);
  const std::size_t section = Shape3{1, row.n_across, row.n_up}.size();
  std::vector<std::vector<int>> depths(static_cast<std::size_t>(row.n_along));
  for (int a = 0; a < row.n_along; ++a) {
    std::vector<int> depth = section_depth(row, a);
    donors.set_section(row, sums, a, depth);
    const std::size_t first = row.index(a, 0, 0);
    std::size_t own = 0;
    for (std::size_t i = 0; i < section; ++i) own += row.state[first + i] == VoxelState::observed ? 1u : 0u;
    if (own < section) depths[a] = std::move(depth);
  }
  // Sums were taken before any value is changed, and filled voxels are no neighbours, so the order does not matter.
  for (int a = 0; a < row.n_along; ++a) {
    const std::vector<int>& depth = depths[a];
    if (depth.empty()) continue;
    const std::size_t first = row.index(a, 0, 0);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < section; ++i) seen += row.seen(first + i) ? 1u : 0u;
    std::size_t i = 0;
    for (int c = 0; c < row.n_across; ++c)
      for (int u = 0; u < row.n_up; ++u, ++i) {
        const std::size_t voxel = first + i;
        if (row.state[voxel] == VoxelState::pooled) take_pool(row, donors, a, u, depth[i], voxel);
        if (row.state[voxel] == VoxelState::unobserved && 2 * seen >= section)
          fill_voxel(row, donors, a, c, u, depth[i]);
      }
  }
}

std::size_t fill_bytes(const Shape3& shape) {
  return Shape3{shape.ni + 1, kDepths + 1, shape.nk}.size() * sizeof(Sum) + shape.size() * sizeof(int);
}

void estimate_paper(RowDensity& row, std::span<const VoxelCounters> counters, std::uint32_t min_rays) {
  for (int a = 0; a < row.n_along; ++a)
    for (int c = 0; c < row.n_across; ++c)
      for (int u = 0; u < row.n_up; ++u) {
        std::uint64_t rays = 0, hits = 0;
        double path = 0;
        for (int reach = 0; reach <= kMaxBorrow; ++reach) {
          rays = 0, hits = 0, path = 0;
          for (int i = std::max(0, a - reach); i <= std::min(row.n_along - 1, a + reach); ++i)
            for (int j = std::max(0, c - reach); j <= std::min(row.n_across - 1, c + reach); ++j)
              for (int k = std::max(0, u - reach); k <= std::min(row.n_up - 1, u + reach); ++k) {
                const VoxelCounters& v = counters[row.index(i, j, k)];
                rays += v.rays, hits += v.hits;
                path += v.path_sides() * row.voxel_m;
              }
          if (rays >= min_rays) break;
        }
        const PaperEstimate e = estimate_paper(rays, hits, path);
        const std::size_t voxel = row.index(a, c, u);
        row.density[voxel] = static_cast<float>(e.density), row.variance[voxel] = static_cast<float>(e.variance);
        const bool own = counters[voxel].rays >= 2;
        row.state[voxel] = own ? VoxelState::observed : e.observed ? VoxelState::filled : VoxelState::unobserved;
      }
}

}  // namespace rayfield::density
