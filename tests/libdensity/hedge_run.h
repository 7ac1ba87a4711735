#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libdensity/estimate/row_density.h"
#include "libdensity/integration/integrate.h"
#include "libdensity/voxels/voxel_accumulator.h"
#include "tests/libdensity/hedge_scene.h"

/// A hedge through counting, estimating and integrating.
namespace rayfield::density::testing {

inline RowDensity density_of(const Hedge& hedge, const tile::SegmentBatch& rays, double voxel_m,
                             const EstimatorOptions& options) {
  const bool wide = hedge.options().sigma_across_m > 0.25;
  const auto row_segments = hedge.row_segments(voxel_m, wide ? 1.2 : 0.72, 2.5);
  const auto wood = hedge.posts();
  std::vector<TileVoxels> tiles;
  LeafSizePairs pairs;
  VoxelOptions count_all;
  count_all.sure_return_m = 0;  // no ray of these scans is missing
  for (int iy = -1; iy <= 0; ++iy)
    for (int ix = -1; ix <= 0; ++ix) {
      auto accumulator = VoxelAccumulator::create({{ix, iy}, 1000}, row_segments, wood, count_all);
      EXPECT_TRUE(accumulator.has_value() && accumulator->add(rays).has_value());
      tiles.push_back(std::move(*accumulator).finish());
      pairs += tiles.back().pairs;
    }
  auto builder = RowDensityBuilder::create(1, row_segments, wood, pairs, options);
  EXPECT_TRUE(builder.has_value());
  for (const TileVoxels& t : tiles) EXPECT_TRUE(builder->add(t).has_value());
  return std::move(*builder).finish();
}

inline std::vector<Panel> panels_of(const Hedge& hedge, double length_m) {
  std::vector<Panel> out;
  const int count = static_cast<int>(std::lround(hedge.options().length_m / length_m));
  for (int k = 0; k < count; ++k) out.push_back({1, k + 1, k * length_m, (k + 1) * length_m});
  return out;
}

/// Leaf area of each panel, the end ones with all that overhangs.
inline std::vector<double> truth_of(const Hedge& hedge, const std::vector<Panel>& panels) {
  std::vector<double> out;
  for (std::size_t i = 0; i < panels.size(); ++i)
    out.push_back(hedge.leaf_area(i == 0 ? -9 : panels[i].start_m, i + 1 == panels.size() ? 1e9 : panels[i].end_m));
  return out;
}

struct Agreement {
  double ratio = 0;  ///< of the sums
  double rrmse = 0;  ///< RMSE over the mean
  double slope = 0;  ///< least squares, of estimate on truth
};

inline Agreement compare(const std::vector<double>& estimate, const std::vector<double>& truth) {
  const auto n = static_cast<double>(truth.size());
  double se = 0, st = 0, ss = 0, sxy = 0, sxx = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    se += estimate[i], st += truth[i], ss += std::pow(estimate[i] - truth[i], 2);
  for (std::size_t i = 0; i < truth.size(); ++i)
    sxy += (truth[i] - st / n) * (estimate[i] - se / n), sxx += std::pow(truth[i] - st / n, 2);
  return {se / st, std::sqrt(ss / n) / (st / n), sxx > 0 ? sxy / sxx : std::nan("")};
}

inline std::vector<double> leaf_areas(const RowDensity& row, const std::vector<Panel>& panels) {
  std::vector<double> out;
  for (const PanelValue& v : integrate_panels(row, panels, 2.75, {})) out.push_back(v.leaf_area_m2);
  return out;
}

}  // namespace rayfield::density::testing
