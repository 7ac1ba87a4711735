#include "libdensity/cloud/voxel_densities.h"

#include <limits>

#include "libdensity/tiles/rounding.h"

namespace rayfield::density {

Result<void> VoxelDensities::add(const RowDensity& row) {
  std::vector<float> values = row.density;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (row.state[i] == VoxelState::unobserved) values[i] = std::numeric_limits<float>::quiet_NaN();
  std::uint64_t first = count_;
  for (const RowSegment& s : row.row_segments) {
    const int across_shift = round_int((s.across_min_m - row.across_min_m) / row.voxel_m);
    const int up_shift = round_int((s.up_min_m - row.up_min_m) / row.voxel_m);
    segments_.push_back({s, first, row.n_across, row.n_up, across_shift, up_shift});
    first += segments_.back().stored_shape().size();
  }
  for (int a = 0; a < row.n_along; ++a)
    for (int c = 0; c < row.n_across; ++c)
      for (int u = 0; u < row.n_up; ++u)
        plant_area_m2 += row.plant_area(a, c, u), canopy_area_m2 += row.canopy_area(a, c, u);
  count_ = first;
  if (values.empty()) return {};
  RAYFIELD_CHECK(file_->append(std::as_bytes(std::span(values))));
  return {};
}

Result<void> VoxelDensities::read(std::uint64_t first, std::span<float> values) const {
  if (values.empty()) return {};
  const auto bytes = std::as_writable_bytes(values);
  return file_->read({first * sizeof(float), bytes.size()}, bytes);
}

}  // namespace rayfield::density
