#include "libdensity/integration/descriptors.h"

#include <algorithm>
#include <cmath>

#include "libdensity/echoes/leaf_angle.h"
#include "libdensity/integration/integrate.h"
#include "libdensity/integration/row_shares.h"
#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

constexpr double kUndefined = CanopyDescriptors::kUndefined;
// Fewer leaves on a line than this are noise about none, and have no first and last ones.
constexpr double kFewestContacts = 0.02;
// A leaf cannot cover more of a face: of the lines about one voxel, few are inside a thin outline.
constexpr double kLargestShare = 0.5;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Share of the layer's height (0…1) between two heights above the ground.
double layer_share(const RowDensity& row, int up, double low_m, double high_m) {
  const double layer = row.up_min_m + up * row.voxel_m;
  return std::clamp((std::min(high_m, layer + row.voxel_m) - std::max(low_m, layer)) / row.voxel_m, 0.0, 1.0);
}

bool line_seen(const RowDensity& row, int along, int up) {
  for (int c = 0; c < row.n_across; ++c)
    if (row.state[row.index(along, c, up)] != VoxelState::unobserved) return true;
  return false;
}

double line_area(const RowDensity& row, int along, int up) {
  double area = 0;
  for (int c = 0; c < row.n_across; ++c) area += row.canopy_area(along, c, up);
  return area;
}

/// Canopy area of a half metre by height and across the row.
struct Layers {
  bool is_seen = false;
  double area_m2 = 0;
  std::vector<double> by_up, by_across;
};

Layers layers_between(const RowDensity& row, const RowSpan& span) {
  Layers layers;
  layers.by_up.assign(at(row.n_up), 0), layers.by_across.assign(at(row.n_across), 0);
  for (int a = 0; a < row.n_along; ++a) {
    const double share = share_between(row, a, span);
    if (share <= 0) continue;
    for (int c = 0; c < row.n_across; ++c)
      for (int u = 0; u < row.n_up; ++u) {
        const double area = share * row.canopy_area(a, c, u);
        layers.area_m2 += area, layers.by_up[at(u)] += area, layers.by_across[at(c)] += area;
        layers.is_seen = layers.is_seen || row.seen(row.index(a, c, u));
      }
  }
  return layers;
}

/// Area of a half metre below which it is a gap.
double gap_area(std::span<const Layers> stretches, double share) {
  std::vector<double> areas;
  for (const Layers& stretch : stretches)
    if (stretch.is_seen) areas.push_back(stretch.area_m2);
  if (areas.empty()) return 0;
  std::sort(areas.begin(), areas.end());
  const std::size_t rank = (3 * areas.size() + 3) / 4;  // nearest rank of 3/4, from 1
  return share * areas[rank - 1];
}

/// What one point of a line meets, on average.
struct Meetings {
  double none = 1, outer = 0;  ///< chance of nothing; number of leaves that are first or last
};

Meetings meetings(double contacts, double leaf_share) {
  const double through_one = std::log1p(-leaf_share);
  const double none = std::exp(contacts / leaf_share * through_one);
  const double one = contacts * std::exp((contacts / leaf_share - 1) * through_one);
  return {none, (1 - none) + (1 - none - one)};
}

}  // namespace

DescriptorSettings descriptor_settings(const ProcessOptions& options, const LeafAngles& leaf_angles) {
  return {options.descriptors, options.integration.height_share, options.integration.width_share,
          options.integration.metre_step_m, leaf_projection(leaf_angles, 0)};
}

std::vector<StretchOutline> canopy_outline(const RowDensity& row, double row_length_m,
                                           const DescriptorSettings& settings) {
  std::vector<Layers> stretches;
  for (const RowSpan& span : metre_spans(row_length_m, settings.metre_step_m))
    stretches.push_back(layers_between(row, span));
  const double least = gap_area(stretches, settings.options.gap_area_share);
  std::vector<StretchOutline> outline;
  for (const Layers& stretch : stretches) {
    StretchOutline part;
    part.is_seen = stretch.is_seen;
    part.is_canopy = stretch.is_seen && stretch.area_m2 > 0 && stretch.area_m2 >= least;
    if (part.is_seen) part.height_m = part.width_m = 0;
    if (part.is_canopy) {
      const auto edge = [&](const std::vector<double>& layers, double share) {
        return quantile_height(layers, row.voxel_m, share);
      };
      part.base_m = row.up_min_m + edge(stretch.by_up, 1 - settings.height_share);
      part.height_m = row.up_min_m + edge(stretch.by_up, settings.height_share);
      part.width_m = edge(stretch.by_across, 0.5 + settings.width_share / 2) -
                     edge(stretch.by_across, 0.5 - settings.width_share / 2);
    }
    outline.push_back(part);
  }
  return outline;
}

std::vector<StretchOutline> outline_of(std::span<const RowMetreProduct> metres, int row_number) {
  std::vector<StretchOutline> outline;
  for (const RowMetreProduct& metre : metres) {
    if (metre.row_number != row_number) continue;
    outline.push_back({std::isfinite(metre.canopy_height_m), metre.descriptors.row_gap_share == 0,
                       metre.descriptors.canopy_base_m, metre.canopy_height_m, metre.canopy_width_m});
  }
  return outline;
}

void put_outline(std::span<const StretchOutline> outline, std::span<RowMetreProduct> metres) {
  for (std::size_t i = 0; i < metres.size(); ++i) {
    metres[i].canopy_height_m = outline[i].height_m, metres[i].canopy_width_m = outline[i].width_m;
    metres[i].descriptors.canopy_base_m = outline[i].base_m;
    metres[i].descriptors.row_gap_share = outline[i].is_seen ? (outline[i].is_canopy ? 0 : 1) : kUndefined;
  }
}

RowLines::RowLines(const RowDensity& row, double row_length_m, std::span<const StretchOutline> outline,
                   const DescriptorSettings& settings)
    : row_(row),
      row_length_m_(row_length_m),
      outline_(outline.begin(), outline.end()),
      settings_(settings),
      columns_(at(row.n_along)) {
  const double face = row.voxel_m * row.voxel_m;
  const std::size_t lines = at(row.n_along) * at(row.n_up);
  std::vector<double> contacts(lines, 0), weight(lines, 0);
  const auto line = [&row](int along, int up) { return at(along) * at(row.n_up) + at(up); };
  for (int a = 0; a < row.n_along; ++a) {
    ColumnSums& column = columns_[at(a)];
    const double middle = row.chainage_m[at(a)] + row.voxel_m / 2;
    const int last = static_cast<int>(outline_.size()) - 1;
    const StretchOutline& part = outline_[at(std::clamp(floor_int(middle / settings.metre_step_m), 0, last))];
    column.is_seen = part.is_seen, column.is_gap = part.is_seen && !part.is_canopy;
    for (int u = 0; u < row.n_up; ++u) {
      const double area = line_area(row, a, u);
      column.zone_m2 +=
          area * layer_share(row, u, settings.options.fruit_zone_low_m, settings.options.fruit_zone_high_m);
      contacts[line(a, u)] = settings.projection * area / face;
      if (part.is_canopy && line_seen(row, a, u)) weight[line(a, u)] = layer_share(row, u, part.base_m, part.height_m);
    }
  }
  for (int a = 0; a < row.n_along; ++a)
    for (int u = 0; u < row.n_up; ++u) {
      const double share = weight[line(a, u)];
      if (!(share > 0)) continue;
      double sum = 0, faces = 0;
      for (int i = std::max(0, a - 1); i <= std::min(row.n_along - 1, a + 1); ++i)
        for (int k = std::max(0, u - 1); k <= std::min(row.n_up - 1, u + 1); ++k)
          sum += weight[line(i, k)] * contacts[line(i, k)], faces += weight[line(i, k)];
      const double smooth = sum / faces;
      const double leaf_share = settings.projection * row.leaf_size_m2 / (faces * face);
      const Meetings met = meetings(smooth, std::clamp(leaf_share, 1e-9, kLargestShare));
      ColumnSums& column = columns_[at(a)];
      column.faces += share, column.contacts += share * contacts[line(a, u)], column.smooth += share * smooth;
      column.open += share * met.none, column.outer += share * met.outer;
    }
}

CanopyDescriptors RowLines::describe(double from_m, double to_m, double length_m, double width_m) const {
  CanopyDescriptors out;
  if (std::isnan(width_m)) return out;
  ColumnSums sum;
  double seen = 0, gaps = 0;
  for (int a = 0; a < row_.n_along; ++a) {
    const ColumnSums& column = columns_[at(a)];
    sum.zone_m2 += share_between(row_, a, {from_m, to_m}) * column.zone_m2;
    // Lines stand between the row's ends: beyond them there is no row that could have gaps.
    const double share = share_between(row_, a, {std::max(from_m, 0.0), std::min(to_m, row_length_m_)});
    if (share <= 0) continue;
    seen += column.is_seen ? share : 0, gaps += column.is_gap ? share : 0;
    sum.faces += share * column.faces, sum.contacts += share * column.contacts, sum.smooth += share * column.smooth;
    sum.open += share * column.open, sum.outer += share * column.outer;
  }
  if (seen > 0) out.row_gap_share = gaps / seen;
  if (sum.faces > 0) {
    out.porosity = sum.open / sum.faces;
    out.leaf_layer_number = sum.contacts / sum.faces;
    if (sum.smooth >= kFewestContacts * sum.faces) out.exposed_leaf_share = sum.outer / sum.smooth;
  }
  out.fruit_zone_area_per_m = sum.zone_m2 / length_m;
  const double height_m = settings_.options.fruit_zone_high_m - settings_.options.fruit_zone_low_m;
  if (width_m > 0) out.fruit_zone_density = out.fruit_zone_area_per_m / (height_m * width_m);
  return out;
}

void RowLines::describe_panels(std::span<const Panel> panels, std::span<PanelValue> values) const {
  const std::vector<RowSpan> spans = panel_spans(panels);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    CanopyDescriptors& out = values[i].descriptors;
    const double base_m = out.canopy_base_m;
    out = describe(spans[i].from_m, spans[i].to_m, panels[i].end_m - panels[i].start_m, values[i].canopy_width_m);
    out.canopy_base_m = base_m;
  }
}

void RowLines::describe_metres(std::span<RowMetreProduct> metres) const {
  const std::vector<RowSpan> spans = metre_spans(row_length_m_, settings_.metre_step_m);
  for (std::size_t i = 0; i < metres.size(); ++i) {
    CanopyDescriptors& out = metres[i].descriptors;
    const CanopyDescriptors outline = out;
    out = describe(spans[i].from_m, spans[i].to_m, settings_.metre_step_m, metres[i].canopy_width_m);
    out.canopy_base_m = outline.canopy_base_m, out.row_gap_share = outline.row_gap_share;
    // A voxel that reaches into a gap from the canopy beside it says nothing of the gap.
    if (!outline_[i].is_canopy) out.porosity = out.leaf_layer_number = out.exposed_leaf_share = kUndefined;
  }
}

std::vector<std::vector<BandAreas>> vertical_profiles(const RowDensity& row, std::span<const Panel> panels,
                                                      double profile_band_m) {
  constexpr double kWhole = 1e-6;  // a grid that ends at a band's border has nothing in the next one
  const double top_m = row.up_min_m + row.n_up * row.voxel_m;
  const int first = floor_int(row.up_min_m / profile_band_m + kWhole);
  const int end = std::max(first + 1, ceil_int(top_m / profile_band_m - kWhole));
  std::vector<std::vector<BandAreas>> profiles;
  for (const RowSpan& span : panel_spans(panels)) {
    std::vector<double> canopy(at(row.n_up), 0), plant(at(row.n_up), 0);
    for (int a = 0; a < row.n_along; ++a) {
      const double share = share_between(row, a, span);
      if (share <= 0) continue;
      for (int u = 0; u < row.n_up; ++u) {
        canopy[at(u)] += share * line_area(row, a, u);
        for (int c = 0; c < row.n_across; ++c) plant[at(u)] += share * row.plant_area(a, c, u);
      }
    }
    std::vector<BandAreas> bands;
    for (int k = first; k < end; ++k) {
      BandAreas band{k * profile_band_m, (k + 1) * profile_band_m};
      for (int u = 0; u < row.n_up; ++u) {
        const double share = layer_share(row, u, band.low_m, band.high_m);
        band.canopy_area_m2 += share * canopy[at(u)], band.plant_area_m2 += share * plant[at(u)];
      }
      bands.push_back(band);
    }
    profiles.push_back(std::move(bands));
  }
  return profiles;
}

}  // namespace rayfield::density
