#include "libdensity/estimate/uneven_density.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "libdensity/estimate/row_fill.h"
#include "libdensity/estimate/slab_density.h"
#include "libdensity/estimate/slab_shadow.h"
#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

// What is missing in voxels of side v, of the fall from there to 2v. Density that changes evenly across a voxel would
// make it a third, unevenness finer than voxels one. Chosen on eight simulated sites (docs/density.md).
constexpr double kMissingOfFall = 0.62;
constexpr double kReachM = 1.5;    // along the row
constexpr double kMostFall = 0.5;  // and rise; few rays scatter, and a bound to one side would be a bias

Shape3 doubled_shape(const Shape3& shape) {
  return {(shape.ni + 1) / 2, (shape.nj + 2) / 2, (shape.nk + 1) / 2};  // across with room for either way
}

/// A row in voxels twice as large.
struct DoubledRow {
  RowDensity row;
  int shift;  ///< voxels across: 0 or 1

  std::size_t index(int along, int across, int up) const { return row.index(along / 2, (across + shift) / 2, up / 2); }
};

VoxelSums at(const RowDensity& row, std::span<const VoxelSums> sums, int along, int across, int up) {
  return 0 <= across && across < row.n_across ? sums[row.index(along, across, up)] : VoxelSums{};
}

std::vector<VoxelSums> doubled_sums(const RowDensity& fine, std::span<const VoxelSums> sums,
                                    const DoubledRow& doubled) {
  std::vector<VoxelSums> out(doubled.row.shape().size());
  for (int a = 0; a < fine.n_along; ++a)
    for (int c = -doubled.shift; c < fine.n_across; c += 2)
      for (int u = 0; u < fine.n_up; ++u) {
        const std::array two{at(fine, sums, a, c, u), at(fine, sums, a, c + 1, u)};
        VoxelSums& sum = out[doubled.index(a, c, u)];
        for (const VoxelSums& v : two) {
          sum.rays += v.rays, sum.hits += v.hits, sum.hits_squared += v.hits_squared;
          sum.path += v.path / 2, sum.hit_path += v.hit_path / 2;
        }
        sum.potential += potential_of_two(two[0], two[1]);
      }
  return out;
}

DoubledRow doubled_row(const RowDensity& fine, std::span<const VoxelSums> sums, int shift) {
  DoubledRow out{{}, shift};
  RowDensity& row = out.row;
  row.row = fine.row, row.voxel_m = 2 * fine.voxel_m, row.leaf_size_m2 = fine.leaf_size_m2;
  const Shape3 shape = doubled_shape(fine.shape());
  row.n_along = shape.ni, row.n_across = shape.nj, row.n_up = shape.nk;
  row.density.assign(shape.size(), 0), row.variance.assign(shape.size(), 0);
  row.state.assign(shape.size(), VoxelState::unobserved);
  const std::vector<VoxelSums> of_doubled = doubled_sums(fine, sums, out);
  estimate_slabs(row, of_doubled);
  pool_and_fill(row, of_doubled);
  return out;
}

bool speaks(VoxelState state) { return state == VoxelState::observed || state == VoxelState::filled; }

/// Of each pair of cross sections; only doubled voxels of which, and of all voxels in them, rays tell enough.
std::vector<TwoSizes> sums_of(const RowDensity& fine, const DoubledRow& doubled) {
  const RowDensity& large = doubled.row;
  std::vector<char> counts(large.shape().size());
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = speaks(large.state[i]) ? 1 : 0;
  const auto for_fine = [&](auto visit) {
    for (int a = 0; a < fine.n_along; ++a)
      for (int c = 0; c < fine.n_across; ++c)
        for (int u = 0; u < fine.n_up; ++u) visit(a, fine.index(a, c, u), doubled.index(a, c, u));
  };
  for_fine([&](int, std::size_t voxel, std::size_t of) {
    if (!speaks(fine.state[voxel])) counts[of] = 0;
  });
  std::vector<TwoSizes> out(static_cast<std::size_t>(large.n_along));
  for_fine([&](int a, std::size_t voxel, std::size_t of) {
    if (counts[of] == 0) return;
    TwoSizes& sum = out[static_cast<std::size_t>(a / 2)];
    sum.fine += static_cast<double>(fine.density[voxel]), sum.doubled += static_cast<double>(large.density[of]);
  });
  return out;
}

/// T(v) up to `reach` pairs of cross sections off each.
std::vector<double> areas_around(std::span<const TwoSizes> sums, int reach) {
  const int count = static_cast<int>(sums.size());
  std::vector<double> out(sums.size(), 0);
  for (int at = 0; at < count; ++at)
    for (int i = std::max(0, at - reach); i <= std::min(count - 1, at + reach); ++i)
      out[static_cast<std::size_t>(at)] += sums[static_cast<std::size_t>(i)].fine;
  return out;
}

/// The fall [T(v) − T(2v)]/T(v) of each pair of cross sections: that of the whole row, shared out as the density
/// around.
std::vector<double> falls_of(std::span<const TwoSizes> sums, int reach) {
  std::vector<double> falls = areas_around(sums, reach);
  double fall = 0, squares = 0;
  for (std::size_t i = 0; i < sums.size(); ++i)
    fall += sums[i].fine - sums[i].doubled, squares += sums[i].fine * falls[i];
  for (double& local : falls) local = squares > 0 ? std::clamp(fall / squares * local, -kMostFall, kMostFall) : 0;
  return falls;
}

}  // namespace

double potential_of_two(const VoxelSums& one, const VoxelSums& other) {
  const auto stopped = [](const VoxelSums& v) {
    return v.potential > 0 ? std::min(1.0, static_cast<double>(v.ends) / v.potential) : 0;
  };
  const double all = one.potential + other.potential, stopped_one = stopped(one), stopped_other = stopped(other);
  const double by_both = stopped_one + stopped_other - stopped_one * stopped_other;
  if (!(by_both > 0)) return all / 2;
  return std::clamp((one.potential * stopped_one + other.potential * stopped_other) / by_both, all / 2, all);
}

void correct_uneven_density(RowDensity& row, std::span<const VoxelSums> sums) {
  const double shadow = slab_shadow(row.leaf_size_m2, row.voxel_m);
  const double shadow_of_doubled = slab_shadow(row.leaf_size_m2, 2 * row.voxel_m);
  row.two_sizes.assign(static_cast<std::size_t>(doubled_shape(row.shape()).ni), {});
  for (const int shift : {0, 1}) {
    const std::vector<TwoSizes> one_way = sums_of(row, doubled_row(row, sums, shift));
    for (std::size_t i = 0; i < one_way.size(); ++i) {
      row.two_sizes[i].fine += one_way[i].fine / (1 + shadow);
      row.two_sizes[i].doubled += one_way[i].doubled / (1 + shadow_of_doubled);
    }
  }
  const std::vector<double> falls = falls_of(row.two_sizes, floor_int(kReachM / (2 * row.voxel_m)));
  const std::size_t section = static_cast<std::size_t>(row.n_across) * static_cast<std::size_t>(row.n_up);
  for (int a = 0; a < row.n_along; ++a) {
    row.uneven.push_back(1 + kMissingOfFall * falls[static_cast<std::size_t>(a / 2)]);
    const double scale = row.uneven.back() / (1 + shadow);
    for (std::size_t i = row.index(a, 0, 0), end = i + section; i < end; ++i) {
      row.density[i] = static_cast<float>(scale * static_cast<double>(row.density[i]));
      row.variance[i] = static_cast<float>(scale * scale * static_cast<double>(row.variance[i]));
    }
  }
}

std::vector<double> correction_of_leaves(const RowDensity& plant, const RowDensity& wood) {
  double of_plants = 0, leaves = 0;
  for (const TwoSizes& sum : plant.two_sizes) of_plants += sum.fine, leaves += sum.fine;
  for (const TwoSizes& sum : wood.two_sizes) leaves -= sum.fine;
  const double share = of_plants > 0 ? std::clamp(leaves / of_plants, 0.0, 1.0) : 0;
  std::vector<double> out(plant.uneven);
  for (double& correction : out) correction = 1 + share * (correction - 1);
  return out;
}

std::size_t correction_bytes(const Shape3& shape) {
  constexpr std::size_t kVoxel = sizeof(VoxelSums) + 2 * sizeof(float) + sizeof(VoxelState) + 2 * sizeof(double);
  const Shape3 doubled = doubled_shape(shape);
  return doubled.size() * kVoxel + fill_bytes(doubled);
}

}  // namespace rayfield::density
