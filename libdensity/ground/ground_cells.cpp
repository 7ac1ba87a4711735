#include "libdensity/ground/ground_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libdensity/tiles/fixed_point.h"
#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double bin_mean(const LowBin& bin, double bin_m) {
  return static_cast<double>(bin.key) * bin_m + metres_from_fixed(bin.sum) / static_cast<double>(bin.count);
}

// A quarter of the way up the hits in the first supported window: less noisy than the minimum, still low in grass.
double supported_low(std::span<const LowBin> bins, double bin_m, const GroundOptions& options) {
  const int window = std::max(1, round_int(options.support_m / bin_m));
  for (std::size_t b = 0; b < bins.size(); ++b) {
    std::uint64_t total = 0;
    for (std::size_t c = b; c < bins.size() && bins[c].key < bins[b].key + window; ++c) total += bins[c].count;
    if (total < static_cast<std::uint64_t>(options.min_support)) continue;
    std::uint64_t seen = 0;
    for (std::size_t c = b; c < bins.size(); ++c) {
      seen += bins[c].count;
      if (4 * seen >= total) return bin_mean(bins[c], bin_m);
    }
  }
  return kNaN;
}

// The second lowest of the candidates around a cell; NaN with fewer than two.
double second_lowest_around(const Grid2<double>& lows, int ix, int iy) {
  double first = std::numeric_limits<double>::infinity(), second = first;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      if ((dx == 0 && dy == 0) || !lows.contains(ix + dx, iy + dy)) continue;
      const double z = lows.at(ix + dx, iy + dy);
      if (z < first) {
        second = first, first = z;
      } else if (z < second) {
        second = z;
      }
    }
  return std::isfinite(second) ? second : kNaN;
}

}  // namespace

GroundCells::GroundCells(tile::TileIndex index, std::span<const TileSurvey* const> surveys, int halo_cells)
    : index_(index), halo_(halo_cells) {
  for (const TileSurvey* survey : surveys) tiles_[survey->index] = survey;
  cells_ = surveys.front()->cells;
  cell_m_ = surveys.front()->cell_m();
  bin_m_ = surveys.front()->bin_m;
  size_ = cells_ + 2 * halo_;
  corner_ =
      Eigen::Vector2d(index.ix, index.iy) * surveys.front()->tile_size_m - Eigen::Vector2d::Constant(halo_ * cell_m_);
}

std::span<const LowBin> GroundCells::bins(int ix, int iy) const {
  const int gx = ix - halo_, gy = iy - halo_;
  const int tx = static_cast<int>(floor_div(gx, cells_)), ty = static_cast<int>(floor_div(gy, cells_));
  const auto it = tiles_.find({index_.ix + tx, index_.iy + ty});
  if (it == tiles_.end()) return {};
  return it->second->cell_bins(gx - tx * cells_, gy - ty * cells_);
}

Grid2<double> supported_lows(const GroundCells& cells, const GroundOptions& options) {
  Grid2<double> lows(cells.corner(), cells.cell_m(), cells.size(), cells.size(), kNaN);
  for (int iy = 0; iy < lows.ny; ++iy)
    for (int ix = 0; ix < lows.nx; ++ix) lows.at(ix, iy) = supported_low(cells.bins(ix, iy), cells.bin_m(), options);
  Grid2<double> kept = lows;
  for (int iy = 0; iy < lows.ny; ++iy)
    for (int ix = 0; ix < lows.nx; ++ix)
      if (lows.at(ix, iy) < second_lowest_around(lows, ix, iy) - options.max_drop_m) kept.at(ix, iy) = kNaN;
  return kept;
}

// The lowest strong peak of the cell's smoothed histogram of heights is the ground: what stands on it lies above, and
// weaker peaks below are scatter. Refined to the mean of the hits around the peak.
CellMode ground_mode(std::span<const LowBin> bins, double bin_m, double hull_m, const GroundOptions& options) {
  constexpr double kBelow = 0.06;       // m; the hull may lie above the ground by its facets' sag and its noise
  constexpr double kHalfWindow = 0.04;  // m; three standard deviations of a lidar's range noise
  constexpr double kShare = 0.35;       // of the strongest peak: a lower peak with less is scatter
  constexpr std::array<double, 5> kKernel{1, 2, 3, 2, 1};
  const std::int32_t first = floor_int((hull_m - kBelow) / bin_m);
  const int n = ceil_int((options.max_rise_m + kBelow) / bin_m) + 1;
  std::vector<double> smooth(static_cast<std::size_t>(n) + 4, 0.0);  // two bins more on each side
  for (const LowBin& bin : bins)
    for (int k = -2; k <= 2; ++k) {
      const std::int64_t at = std::int64_t{bin.key} - first + k + 2;
      if (at >= 0 && at < static_cast<std::int64_t>(smooth.size()))
        smooth[at] += kKernel[static_cast<std::size_t>(k + 2)] * bin.count;
    }
  const double highest = *std::max_element(smooth.begin() + 2, smooth.end() - 2);
  if (highest < 3.0 * options.min_support) return {};

  std::size_t peak = 2;
  while (peak < smooth.size() - 2 &&
         !(smooth[peak] >= kShare * highest && smooth[peak] >= smooth[peak - 1] && smooth[peak] >= smooth[peak + 1]))
    ++peak;
  double height = (static_cast<double>(first) + static_cast<double>(peak) - 2 + 0.5) * bin_m;
  double count = 0;
  for (int iteration = 0; iteration < 4; ++iteration) {
    double sum = 0;
    count = 0;
    for (const LowBin& bin : bins) {
      const double z = bin_mean(bin, bin_m);
      if (std::abs(z - height) > kHalfWindow) continue;
      count += bin.count;
      sum += bin.count * (z - hull_m);
    }
    if (count == 0) return {};
    height = hull_m + sum / count;
  }
  if (count < options.min_support || height > hull_m + options.max_rise_m) return {};
  return {height, std::min(count, 30.0)};
}

}  // namespace rayfield::density
