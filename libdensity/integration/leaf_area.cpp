#include "libdensity/integration/leaf_area.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libdensity/estimate/slab_density.h"
#include "libdensity/estimate/uneven_density.h"
#include "libdensity/integration/interval.h"
#include "libdensity/integration/row_shares.h"

namespace rayfield::density {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void add_section(const RowDensity& leaf, int along, double share, LeafSum& sum, double& voxels, double& observed) {
  for (int c = 0; c < leaf.n_across; ++c)
    for (int u = 0; u < leaf.n_up; ++u) {
      sum.leaf_m2 += share * leaf.canopy_area(along, c, u);
      sum.variance_m4 += share * share * leaf.area_variance(along, c, u);
      voxels += share;
      if (leaf.seen(leaf.index(along, c, u))) observed += share;
    }
}

/// Wood counts where leaves were looked for, and only there.
double wood_in_section(const RowDensity& leaf, const RowDensity& wood, int along) {
  double area = 0;
  for (int c = 0; c < leaf.n_across; ++c)
    for (int u = 0; u < leaf.n_up; ++u)
      if (leaf.state[leaf.index(along, c, u)] != VoxelState::unobserved) area += wood.canopy_area(along, c, u);
  return area;
}

double squared(double x) { return x * x; }

/// Variance of the two scans' sampling alone. How the elements are turned, density·kLeafTurnVariance·leaf area/volume
/// of a voxel's variance (slab_density.h), is not an error of the wood: the same wood stands in both scans.
float sampling_variance(const RowDensity& plant, const RowDensity& wood, std::size_t voxel) {
  const double volume = plant.voxel_m * plant.voxel_m * plant.voxel_m;
  double variance = static_cast<double>(plant.variance[voxel]) + static_cast<double>(wood.variance[voxel]);
  for (const RowDensity* row : {&plant, &wood})
    if (row->state[voxel] == VoxelState::observed)
      variance -= kLeafTurnVariance * static_cast<double>(row->density[voxel]) * row->leaf_size_m2 / volume;
  return static_cast<float>(std::max(0.0, variance));
}

/// What densities of each cross section are multiplied with to be corrected for unevenness as leaves are.
std::vector<double> leaf_scales(const RowDensity& row, std::span<const double> of_leaves) {
  std::vector<double> scales(row.chainage_m.size(), 1);
  for (std::size_t along = 0; along < row.uneven.size(); ++along) scales[along] = of_leaves[along] / row.uneven[along];
  return scales;
}

}  // namespace

Result<RowDensity> subtract_wood(RowDensity plant, const RowDensity& wood) {
  if (plant.shape() != wood.shape() || plant.voxel_m != wood.voxel_m || plant.chainage_m != wood.chainage_m ||
      plant.across_min_m != wood.across_min_m || plant.up_min_m != wood.up_min_m)
    return fail(ErrorCode::internal, "cannot subtract wood", "row " + std::to_string(plant.row),
                "it was counted in another grid", "please report this");
  const std::vector<double> of_leaves = correction_of_leaves(plant, wood);
  const std::vector<double> plant_scales = leaf_scales(plant, of_leaves), wood_scales = leaf_scales(wood, of_leaves);
  const std::size_t section = plant.shape().size() / plant.chainage_m.size();
  for (std::size_t i = 0; i < plant.density.size(); ++i) {
    const double plant_scale = plant_scales[i / section], wood_scale = wood_scales[i / section];
    const bool known = plant.state[i] != VoxelState::unobserved && wood.state[i] != VoxelState::unobserved;
    const bool both_seen = plant.seen(i) && wood.seen(i);
    plant.variance[i] = known ? sampling_variance(plant, wood, i) : 0.0F;
    plant.density[i] = known ? static_cast<float>(plant_scale * static_cast<double>(plant.density[i]) -
                                                  wood_scale * static_cast<double>(wood.density[i]))
                             : 0.0F;
    plant.state[i] = both_seen ? VoxelState::observed : known ? VoxelState::filled : VoxelState::unobserved;
  }
  plant.wood_area.clear();
  return plant;
}

std::vector<LeafSum> leaf_of_panels(const RowDensity& leaf, const RowDensity& wood, std::span<const Panel> panels) {
  std::vector<LeafSum> sums;
  for (const RowSpan& span : panel_spans(panels)) {
    LeafSum sum;
    double voxels = 0, observed = 0;
    for (int a = 0; a < leaf.n_along; ++a) {
      const double share = share_between(leaf, a, span);
      if (share <= 0) continue;
      add_section(leaf, a, share, sum, voxels, observed);
      sum.wood_m2 += share * wood_in_section(leaf, wood, a);
    }
    sum.variance_m4 += kLeafTurnVariance * leaf.leaf_size_m2 * std::max(0.0, sum.leaf_m2);
    sum.observed_fraction = voxels > 0 ? observed / voxels : 0;
    sums.push_back(sum);
  }
  return sums;
}

std::vector<double> leaf_of_metres(const RowDensity& leaf, double row_length_m, double metre_step_m) {
  std::vector<double> areas;
  int first = 0;  // columns before it end before the span begins
  for (const RowSpan& span : metre_spans(row_length_m, metre_step_m)) {
    LeafSum sum;
    double voxels = 0, observed = 0;
    while (first < leaf.n_along && leaf.chainage_m[static_cast<std::size_t>(first)] + leaf.voxel_m <= span.from_m)
      ++first;
    for (int a = first; a < leaf.n_along && leaf.chainage_m[static_cast<std::size_t>(a)] < span.to_m; ++a)
      add_section(leaf, a, share_between(leaf, a, span), sum, voxels, observed);
    areas.push_back(observed > 0 ? sum.leaf_m2 / metre_step_m : kNaN);
  }
  return areas;
}

void set_leaf_area(PanelValue& value, const LeafSum& sum, double length_m, double row_spacing_m,
                   const IntegrationOptions& integration, const LeafOptions& options) {
  if (!std::isfinite(value.plant_area_m2) || !(sum.observed_fraction >= integration.min_observed_fraction)) {
    value.leaf_area_m2 = value.leaf_area_per_m = value.lai = kNaN;
    value.se_leaf_area_m2 = value.ci_low_m2 = value.ci_high_m2 = kNaN;
    return;
  }
  value.leaf_area_m2 = sum.leaf_m2;
  value.leaf_area_per_m = sum.leaf_m2 / length_m;
  value.lai = sum.leaf_m2 / (length_m * row_spacing_m);
  value.se_leaf_area_m2 = std::sqrt(sum.variance_m4);
  const double variance_m4 = sum.variance_m4 + squared(options.wood_error * sum.wood_m2);
  const Reach reach = reach_of(sum.leaf_m2, variance_m4, integration.shared_error);
  value.ci_low_m2 = std::max(0.0, sum.leaf_m2 - reach.below);
  value.ci_high_m2 = std::max(0.0, sum.leaf_m2 + reach.above);
}

}  // namespace rayfield::density
