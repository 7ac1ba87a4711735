#include "libdensity/estimate/row_density.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "libdensity/estimate/row_fill.h"
#include "libdensity/estimate/row_wood.h"
#include "libdensity/estimate/slab_density.h"
#include "libdensity/estimate/uneven_density.h"
#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

/// Along index of each row segment's first column.
std::vector<int> first_columns(const RowDensity& row) {
  std::vector<int> first;
  int along = 0;
  for (const RowSegment& s : row.row_segments) first.push_back(along), along += s.n_along;
  return first;
}

Result<void> check_lattice(const RowDensity& row, const RowSegment& s) {
  const double across = (s.across_min_m - row.across_min_m) / row.voxel_m,
               up = (s.up_min_m - row.up_min_m) / row.voxel_m;
  if (s.voxel_m == row.voxel_m && std::abs(across - std::round(across)) < 1e-6 && std::abs(up - std::round(up)) < 1e-6)
    return {};
  return fail(ErrorCode::usage, "cannot lay out a row's voxels",
              "row " + std::to_string(s.row) + ", row segment " + std::to_string(s.index),
              "its voxels are not on the lattice of the row's first row segment",
              "give all row segments of a row one voxel size and snapped extents");
}

}  // namespace

Eigen::Vector2d RowDensity::center(int along, int across) const {
  const RowSegment& s = row_segment(along);
  const double a = chainage_m[along] - s.chainage_m + 0.5 * voxel_m, c = across_min_m + (across + 0.5) * voxel_m;
  return s.origin + a * s.direction + c * Eigen::Vector2d(-s.direction.y(), s.direction.x());
}

double RowDensity::canopy_area(int along, int across, int up) const {
  const double share = free_share.empty() ? 1.0 : static_cast<double>(free_share[column_index(along, across)]);
  return static_cast<double>(density[index(along, across, up)]) * voxel_m * voxel_m * voxel_m * share;
}

double RowDensity::plant_area(int along, int across, int up) const {
  return canopy_area(along, across, up) + wood_area_at(index(along, across, up));
}

double RowDensity::area_variance(int along, int across, int up) const {
  const double volume = voxel_m * voxel_m * voxel_m;
  return static_cast<double>(variance[index(along, across, up)]) * volume * volume;
}

Result<RowDensityBuilder> RowDensityBuilder::create(int row, std::span<const RowSegment> row_segments,
                                                    std::span<const WoodCylinder> wood, const LeafSizePairs& pairs,
                                                    const EstimatorOptions& options,
                                                    const std::optional<EchoModel>& model) {
  RAYFIELD_CHECK(options.validate());
  RowDensityBuilder out;
  out.options_ = options;
  out.model_ = model;
  RowDensity& r = out.row_;
  r.row = row;
  for (const RowSegment& s : row_segments)
    if (s.row == row) r.row_segments.push_back(s);
  if (r.row_segments.empty())
    return fail(ErrorCode::usage, "cannot estimate density", "row " + std::to_string(row), "it has no row segments");
  std::sort(r.row_segments.begin(), r.row_segments.end(), [](const RowSegment& a, const RowSegment& b) {
    return a.first_along != b.first_along ? a.first_along < b.first_along : a.index < b.index;
  });
  const RowSegment& first = r.row_segments.front();
  r.voxel_m = first.voxel_m, r.across_min_m = first.across_min_m, r.up_min_m = first.up_min_m;
  int low_across = 0, low_up = 0;
  for (std::size_t i = 0; i < r.row_segments.size(); ++i) {
    const RowSegment& s = r.row_segments[i];
    RAYFIELD_CHECK(check_lattice(r, s));
    const int across = round_int((s.across_min_m - first.across_min_m) / r.voxel_m);
    const int up = round_int((s.up_min_m - first.up_min_m) / r.voxel_m);
    low_across = std::min(low_across, across), low_up = std::min(low_up, up);
    r.n_across = std::max(r.n_across, across + s.n_across), r.n_up = std::max(r.n_up, up + s.n_up);
    r.segment_of.insert(r.segment_of.end(), static_cast<std::size_t>(s.n_along), static_cast<std::int32_t>(i));
    for (int a = 0; a < s.n_along; ++a) r.chainage_m.push_back(s.chainage_m + a * r.voxel_m);
  }
  r.n_across -= low_across, r.n_up -= low_up;
  r.across_min_m += low_across * r.voxel_m, r.up_min_m += low_up * r.voxel_m;
  r.n_along = static_cast<int>(r.segment_of.size());
  r.entries.assign(r.segment_of.size(), 0);
  out.counters_.assign(r.shape().size(), {});
  if (model) out.echoes_.assign(r.shape().size(), {});
  r.leaf_size_m2 = options.leaf_size_m2 >= 0 ? options.leaf_size_m2
                   : model                   ? model->leaf_size_m2
                                             : estimate_leaf_size(pairs).area_m2;
  for (const WoodCylinder& w : wood)
    if (w.row == row) out.wood_.push_back(w);
  return out;
}

Result<void> RowDensityBuilder::add(const TileVoxels& tile) {
  const std::vector<int> first = first_columns(row_);
  for (const RowSegmentVoxels& block : tile.row_segments) {
    if (block.row_segment.row != row_.row) continue;
    const auto found = std::find_if(row_.row_segments.begin(), row_.row_segments.end(),
                                    [&](const RowSegment& s) { return s.index == block.row_segment.index; });
    const std::string where = "tile " + std::to_string(tile.tile.ix) + "_" + std::to_string(tile.tile.iy);
    if (found == row_.row_segments.end() || found->shape() != block.row_segment.shape())
      return fail(ErrorCode::damaged, "cannot use counted voxels", where,
                  "they belong to other row segments of row " + std::to_string(row_.row),
                  "run `rayfield process` again");
    const auto k = static_cast<std::size_t>(found - row_.row_segments.begin());
    const auto across_shift = round_int((found->across_min_m - row_.across_min_m) / row_.voxel_m);
    const auto up_shift = round_int((found->up_min_m - row_.up_min_m) / row_.voxel_m);
    for (int a = 0; a < found->n_along; ++a)
      for (int c = 0; c < found->n_across; ++c) {
        const auto column = block.column_voxels(a, c);
        if (column.empty()) continue;
        const std::int32_t number = block.column[found->shape().column(a, c)];
        row_.entries[first[k] + a] += block.entries[number];
        const std::size_t to = row_.index(first[k] + a, c + across_shift, up_shift);
        for (std::size_t u = 0; u < column.size(); ++u) counters_[to + u] += column[u];
        if (!model_) continue;
        const auto echoes = block.column_echoes(a, c);
        for (std::size_t u = 0; u < echoes.size(); ++u) echoes_[to + u] += echoes[u];
      }
  }
  return {};
}

std::size_t RowDensityBuilder::peak_bytes(const Shape3& shape, bool wide) {
  constexpr std::size_t kSums = sizeof(VoxelSums);
  constexpr std::size_t kDensity = 2 * sizeof(float) + sizeof(VoxelState) + sizeof(float);  // with masked wood
  const std::size_t counted = kSums + sizeof(VoxelCounters) + (wide ? sizeof(EchoCounters) : 0);
  const std::size_t in_slabs = kSums + kDensity + 2 * sizeof(double);
  const std::size_t filled = shape.size() * (kSums + kDensity) + std::max(fill_bytes(shape), correction_bytes(shape));
  return std::max(shape.size() * std::max(counted, in_slabs), filled);
}

RowDensity RowDensityBuilder::finish() && {
  RowDensity& r = row_;
  const std::size_t voxels = counters_.size();
  const auto assign = [&] {
    r.density.assign(voxels, 0);
    r.variance.assign(voxels, 0);
    r.state.assign(voxels, VoxelState::unobserved);
  };
  if (options_.estimator == Estimator::paper) {
    assign();
    estimate_paper(r, counters_, static_cast<std::uint32_t>(options_.paper_min_rays));
    counters_ = {}, echoes_ = {};
  } else {
    const CrossSection across{static_cast<std::size_t>(r.n_across), static_cast<std::size_t>(r.n_up), r.voxel_m};
    const std::vector<VoxelSums> sums =
        model_ ? wide_beam_sums(counters_, echoes_, across, *model_) : thin_ray_sums(counters_);
    counters_ = {}, echoes_ = {};
    assign();
    estimate_slabs(r, sums);
    pool_and_fill(r, sums);
    correct_uneven_density(r, sums);
  }
  add_wood(r, wood_);
  return std::move(row_);
}

}  // namespace rayfield::density
