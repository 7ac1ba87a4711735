#include "libdensity/integration/integrate.h"
#include "libdensity/integration/interval.h"
#include "libdensity/integration/row_shares.h"
#include "libdensity/tiles/rounding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace rayfield::density {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Sums over a part of a row, columns weighted by the share of their length that lies in it.
struct Sums {
  double plant = 0, leaf = 0, variance = 0;
  double voxels = 0, observed = 0, rays = 0;
  std::vector<double> by_up, by_across;  ///< leaf area

  double observed_fraction() const { return voxels > 0 ? observed / voxels : 0; }
  bool is_seen(const IntegrationOptions& o) const {
    return observed > 0 && observed_fraction() >= o.min_observed_fraction;
  }
};

void add_section(const RowDensity& row, int along, double share, Sums& s) {
  for (int c = 0; c < row.n_across; ++c)
    for (int u = 0; u < row.n_up; ++u) {
      const std::size_t voxel = row.index(along, c, u);
      const double canopy = share * row.canopy_area(along, c, u);
      s.leaf += canopy;
      s.plant += canopy + share * row.wood_area_at(voxel);
      s.variance += share * share * row.area_variance(along, c, u);
      s.voxels += share;
      if (row.seen(voxel)) s.observed += share;
      s.by_up[at(u)] += canopy, s.by_across[at(c)] += canopy;
    }
  s.rays += share * row.entries[at(along)];
}

Sums sum_between(const RowDensity& row, const RowSpan& span) {
  Sums s;
  s.by_up.assign(at(row.n_up), 0), s.by_across.assign(at(row.n_across), 0);
  for (int a = 0; a < row.n_along; ++a) {
    const double share = share_between(row, a, span);
    if (share > 0) add_section(row, a, share, s);
  }
  return s;
}

/// Share of light that crosses the side view horizontally, over the layers from `low` to `high` (Beer's law with the
/// spherical projection ½ along every line of voxels across the row; wood there stops all that its outline covers).
double gap_between(const RowDensity& row, const RowSpan& span, int low, int high) {
  double cells = 0, light = 0;
  const double face = row.voxel_m * row.voxel_m;
  for (int a = 0; a < row.n_along; ++a) {
    const double share = share_between(row, a, span);
    if (share <= 0) continue;
    for (int u = low; u <= high; ++u) {
      double canopy = 0, wood = 0;
      for (int c = 0; c < row.n_across; ++c)
        canopy += row.canopy_area(a, c, u), wood += row.wood_area_at(row.index(a, c, u));
      // A post shows 2/π of its half surface to the side.
      const double open = std::max(0.0, 1 - wood * 0.6366197723675814 / face);
      cells += share, light += share * open * std::exp(-0.5 * canopy / face);
    }
  }
  return cells > 0 ? light / cells : kNaN;
}

PanelValue panel_value(const RowDensity& row, const Sums& s, const RowSpan& span, double length_m, double spacing_m,
                       const IntegrationOptions& o) {
  PanelValue v;
  v.observed_fraction = s.observed_fraction();
  v.ray_count = std::llround(s.rays);
  if (!s.is_seen(o)) {
    v.plant_area_m2 = v.leaf_area_m2 = v.leaf_area_per_m = v.lai = v.se_leaf_area_m2 = v.se_plant_area_m2 = kNaN;
    v.ci_low_m2 = v.ci_high_m2 = v.canopy_height_m = v.canopy_width_m = v.gap_fraction = kNaN;
    return v;
  }
  v.plant_area_m2 = s.plant, v.leaf_area_m2 = s.leaf;
  v.leaf_area_per_m = s.leaf / length_m;
  v.lai = s.leaf / (length_m * spacing_m);
  v.se_leaf_area_m2 = v.se_plant_area_m2 = std::sqrt(s.variance);
  const Reach reach = reach_of(s.leaf, s.variance, o.shared_error);
  v.ci_low_m2 = std::max(0.0, s.leaf - reach.below), v.ci_high_m2 = s.leaf + reach.above;
  if (!(s.leaf > 0)) {
    v.canopy_height_m = v.canopy_width_m = 0;
    v.gap_fraction = 1;
    return v;
  }
  const double top = quantile_height(s.by_up, row.voxel_m, o.height_share);
  const double bottom = quantile_height(s.by_up, row.voxel_m, 1 - o.height_share);
  v.canopy_height_m = row.up_min_m + top;
  v.descriptors.canopy_base_m = row.up_min_m + bottom;
  v.canopy_width_m = quantile_height(s.by_across, row.voxel_m, 0.5 + o.width_share / 2) -
                     quantile_height(s.by_across, row.voxel_m, 0.5 - o.width_share / 2);
  const int low = std::clamp(static_cast<int>(bottom / row.voxel_m), 0, row.n_up - 1);
  const int high = std::clamp(ceil_int(top / row.voxel_m) - 1, low, row.n_up - 1);
  v.gap_fraction = gap_between(row, span, low, high);
  return v;
}

}  // namespace

double quantile_height(std::span<const double> layer_area, double layer_m, double share) {
  double total = 0, below = 0;
  for (const double a : layer_area) total += a;
  if (!(total > 0)) return kNaN;
  const double wanted = share * total;
  std::size_t last = 0;
  for (std::size_t i = 0; i < layer_area.size(); ++i) {
    if (layer_area[i] > 0) last = i;
    if (layer_area[i] > 0 && below + layer_area[i] >= wanted)
      return layer_m * (static_cast<double>(i) + (wanted - below) / layer_area[i]);
    below += layer_area[i];
  }
  return layer_m * static_cast<double>(last + 1);
}

std::vector<PanelValue> integrate_panels(const RowDensity& row, std::span<const Panel> panels, double row_spacing_m,
                                         const IntegrationOptions& options) {
  std::vector<PanelValue> out;
  const std::vector<RowSpan> spans = panel_spans(panels);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const double length = panels[i].end_m - panels[i].start_m;
    out.push_back(panel_value(row, sum_between(row, spans[i]), spans[i], length, row_spacing_m, options));
  }
  return out;
}

std::vector<RowMetreProduct> row_metres(const RowDensity& row, double row_length_m, const IntegrationOptions& options) {
  const double step = options.metre_step_m;
  const std::vector<RowSpan> spans = metre_spans(row_length_m, step);
  const int count = static_cast<int>(spans.size());
  std::vector<Sums> sums(spans.size());
  for (Sums& s : sums) s.by_up.assign(at(row.n_up), 0), s.by_across.assign(at(row.n_across), 0);
  for (int a = 0; a < row.n_along; ++a) {
    const double low = row.chainage_m[at(a)], high = low + row.voxel_m;
    const int first = std::clamp(floor_int(low / step), 0, count - 1);
    const int last = std::clamp(floor_int(high / step), 0, count - 1);
    for (int k = first; k <= last; ++k) {
      const double share = share_between(row, a, spans[at(k)]);
      if (share > 0) add_section(row, a, share, sums[at(k)]);
    }
  }
  std::vector<RowMetreProduct> out;
  for (int k = 0; k < count; ++k) {
    const Sums& s = sums[at(k)];
    RowMetreProduct m;
    m.row_number = row.row;
    m.chainage_m = (k + 0.5) * step;
    const auto after = std::upper_bound(row.chainage_m.begin(), row.chainage_m.end(), m.chainage_m);
    const int along = std::max(0, static_cast<int>(after - row.chainage_m.begin()) - 1);
    const RowSegment& row_segment = row.row_segment(along);
    m.position = row_segment.origin + (m.chainage_m - row_segment.chainage_m) * row_segment.direction;
    const bool seen = s.is_seen(options);
    m.leaf_area_per_m = seen ? s.leaf / step : kNaN;
    m.plant_area_per_m = seen ? s.plant / step : kNaN;
    out.push_back(m);
  }
  return out;
}

SectionProduct side_view(const RowDensity& row) {
  SectionProduct out{"side_view_row_" + std::to_string(row.row), "m2/m2", row.row, {}};
  out.grid = Grid2<float>({row.chainage_m.empty() ? 0.0 : row.chainage_m.front(), row.up_min_m}, row.voxel_m,
                          row.n_along, row.n_up, std::numeric_limits<float>::quiet_NaN());
  const double face = row.voxel_m * row.voxel_m;
  for (int a = 0; a < row.n_along; ++a)
    for (int u = 0; u < row.n_up; ++u) {
      double area = 0;
      bool seen = false;
      for (int c = 0; c < row.n_across; ++c) {
        area += row.plant_area(a, c, u);
        seen = seen || row.state[row.index(a, c, u)] != VoxelState::unobserved;
      }
      if (seen) out.grid.at(a, u) = static_cast<float>(area / face);
    }
  return out;
}

SectionProduct end_on_section(const RowDensity& row, double row_length_m) {
  SectionProduct out{"end_on_row_" + std::to_string(row.row), "m2/m3", row.row, {}};
  out.grid = Grid2<float>({row.across_min_m, row.up_min_m}, row.voxel_m, row.n_across, row.n_up,
                          std::numeric_limits<float>::quiet_NaN());
  const double volume = row.voxel_m * row.voxel_m * row_length_m;
  for (int c = 0; c < row.n_across; ++c)
    for (int u = 0; u < row.n_up; ++u) {
      double area = 0;
      bool seen = false;
      for (int a = 0; a < row.n_along; ++a) {
        area += row.plant_area(a, c, u);
        seen = seen || row.state[row.index(a, c, u)] != VoxelState::unobserved;
      }
      if (seen) out.grid.at(c, u) = static_cast<float>(area / volume);
    }
  return out;
}

}  // namespace rayfield::density
