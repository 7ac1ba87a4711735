#include "libdensity/voxels/row_segments.h"

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <limits>
#include <numeric>

#include "libdensity/layout/polyline.h"
#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kWhat = "cannot lay out the voxels";

// Value below which a share of the counts lies, linear within the bin.
double quantile(const std::vector<std::int64_t>& counts, double share, double first_m, double bin_m) {
  const std::int64_t total = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  if (total == 0) return kNaN;
  const double wanted = share * static_cast<double>(total);
  double below = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double here = static_cast<double>(counts[i]);
    if (here > 0 && below + here >= wanted)
      return first_m + bin_m * (static_cast<double>(i) + std::clamp((wanted - below) / here, 0.0, 1.0));
    below += here;
  }
  return first_m + bin_m * static_cast<double>(counts.size());
}

// Share of the counts outside of [low, high], by bin centres.
double share_outside(const std::vector<std::int64_t>& counts, double first_m, double bin_m, double low, double high) {
  std::int64_t total = 0, outside = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double at = first_m + bin_m * (static_cast<double>(i) + 0.5);
    total += counts[i];
    if (at < low || at > high) outside += counts[i];
  }
  return total > 0 ? static_cast<double>(outside) / static_cast<double>(total) : 0.0;
}

RowExtents extents_of_row(int number, const CanopyProfile& profile, double limit_m, const RowSegmentOptions& o) {
  RowExtents e;
  e.row = number;
  e.across_low_m = e.across_high_m = e.up_high_m = kNaN;
  double low = -o.min_half_width_m, high = o.min_half_width_m, top = o.up_min_m + o.min_height_m;
  const auto across = profile.across.find(number), up = profile.up.find(number);
  const bool known = across != profile.across.end() && up != profile.up.end();
  if (known) e.hits = std::accumulate(across->second.begin(), across->second.end(), std::int64_t{0});
  if (e.hits > 0) {
    const double margin = o.widen_voxels * o.voxel_m;
    e.across_low_m = quantile(across->second, o.across_low, -profile.half_width_m, profile.bin_m);
    e.across_high_m = quantile(across->second, o.across_high, -profile.half_width_m, profile.bin_m);
    e.up_high_m = quantile(up->second, o.up_high, profile.up_min_m, profile.bin_m);
    low = std::min(low, e.across_low_m - margin), high = std::max(high, e.across_high_m + margin);
    top = std::max(top, e.up_high_m + margin);
  }
  // Whole voxels, outwards; half the spacing is where the neighbour's canopy begins.
  const int most = std::max(1, floor_int(limit_m / o.voxel_m + 1e-9));
  const int first = std::max(-most, floor_int(low / o.voxel_m + 1e-9));
  const int last = std::min(most, ceil_int(high / o.voxel_m - 1e-9));
  const int n_up = std::max(1, ceil_int((std::min(top, o.max_height_m) - o.up_min_m) / o.voxel_m - 1e-9));
  e.across_min_m = first * o.voxel_m, e.across_max_m = last * o.voxel_m;
  e.up_max_m = o.up_min_m + n_up * o.voxel_m;
  if (e.hits > 0)
    e.outside_share = std::min(
        1.0, share_outside(across->second, -profile.half_width_m, profile.bin_m, e.across_min_m, e.across_max_m) +
                 share_outside(up->second, profile.up_min_m, profile.bin_m, o.up_min_m, e.up_max_m));
  return e;
}

// The ground under a row segment, in its own axes: a plane with the slopes of the ground under its whole width, raised
// to the ground at the row's line. Vines often stand on a bank, and heights count from where they stand: a plane laid
// through bank and lane alike runs about half a bank below its crest. False where too little ground is known.
bool fit_ground(const GroundModel& ground, double length_m, double across_min_m, double across_max_m, RowSegment& s) {
  constexpr int kAlong = 7, kAcross = 5;
  const Eigen::Vector2d left(-s.direction.y(), s.direction.x());
  const auto height = [&](double along, double across) {
    const Eigen::Vector2d p = s.origin + s.direction * along + left * across;
    return ground.height(p.x(), p.y());
  };
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  std::optional<double> base;
  int known = 0;
  for (int i = 0; i < kAlong; ++i)
    for (int j = 0; j < kAcross; ++j) {
      const double along = length_m * i / (kAlong - 1);
      const double across = across_min_m + (across_max_m - across_min_m) * j / (kAcross - 1);
      const auto z = height(along, across);
      if (!z) continue;
      if (!base) base = *z;
      ++known;
      const Eigen::Vector3d row(1, along, across);
      normal += row * row.transpose();
      right += row * (*z - *base);
    }
  if (known < kAlong * kAcross / 2) return false;
  normal(1, 1) += 1e-6, normal(2, 2) += 1e-6;
  const Eigen::Vector3d plane = normal.ldlt().solve(right);
  s.ground_m = *base + plane(0), s.slope_along = plane(1), s.slope_across = plane(2);

  double above = 0;  // the ground at the row's line over the plane; the plane alone where that ground is unknown
  int at_line = 0;
  for (int i = 0; i < kAlong; ++i) {
    const double along = length_m * i / (kAlong - 1);
    if (const auto z = height(along, 0)) above += *z - (s.ground_m + s.slope_along * along), ++at_line;
  }
  if (at_line > kAlong / 2) s.ground_m += above / at_line;
  return true;
}

}  // namespace

std::vector<RowExtents> row_extents(const RowLayout& layout, const CanopyProfile& profile,
                                    const RowSegmentOptions& options) {
  const double limit = layout.spacing_m > 0 ? 0.5 * layout.spacing_m : options.lone_half_width_m;
  std::vector<RowExtents> extents;
  for (const Row& row : layout.rows) extents.push_back(extents_of_row(row.number, profile, limit, options));
  return extents;
}

Result<RowSegmentList> make_row_segments(const RowLayout& layout, const GroundModel& ground,
                                         const CanopyProfile& profile, const RowSegmentOptions& options) {
  RAYFIELD_CHECK(options.validate());
  RowSegmentList out;
  out.extents = row_extents(layout, profile, options);
  for (std::size_t r = 0; r < layout.rows.size(); ++r) {
    const Row& row = layout.rows[r];
    const RowExtents& e = out.extents[r];
    const int columns = std::max(1, ceil_int(row.length_m() / options.voxel_m - 1e-6));
    int left_out = 0;
    for (int first = 0, index = 0; first < columns; first += options.voxels_per_segment, ++index) {
      RowSegment s;
      s.row = row.number, s.index = index, s.first_along = first, s.voxel_m = options.voxel_m;
      s.n_along = std::min(options.voxels_per_segment, columns - first);
      s.chainage_m = first * options.voxel_m;
      const double length = s.n_along * options.voxel_m;
      s.origin = point_at(row.centreline, s.chainage_m).position;
      s.direction = (point_at(row.centreline, s.chainage_m + length).position - s.origin).normalized();
      s.across_min_m = e.across_min_m, s.up_min_m = options.up_min_m;
      s.n_across = round_int((e.across_max_m - e.across_min_m) / options.voxel_m);
      s.n_up = round_int((e.up_max_m - options.up_min_m) / options.voxel_m);
      if (fit_ground(ground, length, e.across_min_m, e.across_max_m, s)) {
        out.row_segments.push_back(s);
      } else {
        ++left_out;
      }
    }
    if (left_out > 0)
      out.warnings.push_back(
          fmt::format("row {}: {} row segments of {:.1f} m have no voxels because the ground under them is unknown",
                      row.number, left_out, options.voxels_per_segment * options.voxel_m));
  }
  return out;
}

}  // namespace rayfield::density
