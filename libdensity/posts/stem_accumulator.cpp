#include "libdensity/posts/stem_accumulator.h"

#include <algorithm>

#include "libdensity/layout/polyline.h"
#include "libdensity/layout/row_locator.h"
#include "libdensity/posts/stem_grid.h"
#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

constexpr double kMargin = 0.25;  // m; the reach of tile files beyond the tile
constexpr double kBeyond = 0.8;   // m; posts stand a little outside of the traced canopy

}  // namespace

struct StemAccumulator::Impl {
  tile::TileRef tile;
  const RowLayout* layout;
  const GroundModel* ground;
  PostOptions options;
  RowLocator locator;
  std::vector<StemGrid> grids;
  std::vector<int> grid_of_row;
};

StemAccumulator::StemAccumulator(const tile::TileRef& tile, const RowLayout& layout, const GroundModel& ground,
                                 const PostOptions& options)
    : impl_(
          new Impl{tile, &layout, &ground, options, RowLocator(layout, tile, kMargin, options.half_width_m), {}, {}}) {
  impl_->grid_of_row.assign(layout.rows.size(), -1);
  for (const auto& interval : impl_->locator.intervals()) {
    StemGrid grid;
    grid.row = interval.row;
    grid.cell_m = options.cell_m, grid.layer_m = options.layer_m, grid.half_width_m = options.half_width_m;
    grid.first_along = floor_int((interval.start_m - kBeyond) / options.cell_m);
    grid.n_along = ceil_int((interval.end_m + kBeyond) / options.cell_m) - grid.first_along;
    grid.n_across = round_int(2 * options.half_width_m / options.cell_m);
    grid.n_layers = round_int(options.top_m / options.layer_m);
    grid.counts.assign(grid.shape().size(), 0);
    impl_->grid_of_row[interval.row] = static_cast<int>(impl_->grids.size());
    impl_->grids.push_back(std::move(grid));
  }
}

StemAccumulator::~StemAccumulator() = default;
StemAccumulator::StemAccumulator(const StemAccumulator& other) : impl_(new Impl(*other.impl_)) {}
StemAccumulator::StemAccumulator(StemAccumulator&&) noexcept = default;
StemAccumulator& StemAccumulator::operator=(StemAccumulator&&) noexcept = default;

void StemAccumulator::add(const tile::HitBatch& hits) {
  for (const Eigen::Vector3d& p : hits.end) {
    const auto place = impl_->locator.locate(p.head<2>(), kBeyond);
    if (!place) continue;
    const auto ground = impl_->ground->height(p.x(), p.y());
    if (!ground) continue;
    StemGrid& grid = impl_->grids[static_cast<std::size_t>(impl_->grid_of_row[place->row])];
    const int layer = floor_int((p.z() - *ground) / grid.layer_m);
    const int a = floor_int(place->chainage_m / grid.cell_m) - grid.first_along;
    const int c = floor_int((place->across_m + grid.half_width_m) / grid.cell_m);
    if (!grid.shape().contains(a, c, layer)) continue;
    std::uint8_t& cell = grid.counts[grid.shape().index(a, c, layer)];
    if (cell < 255) ++cell;
  }
}

bool StemAccumulator::empty() const { return impl_->grids.empty(); }

void StemAccumulator::merge(const StemAccumulator& other) {
  for (std::size_t g = 0; g < impl_->grids.size(); ++g) {
    auto& mine = impl_->grids[g].counts;
    const auto& theirs = other.impl_->grids[g].counts;
    for (std::size_t i = 0; i < mine.size(); ++i)
      mine[i] = static_cast<std::uint8_t>(std::min(255, mine[i] + theirs[i]));
  }
}

std::vector<Stem> StemAccumulator::finish() const {
  // Both neighbours see a stem on their border; a hair's breadth more than the tile makes sure that one keeps it.
  constexpr double kHair = 0.02;
  const Eigen::Vector2d low = impl_->tile.corner();
  std::vector<Stem> stems;
  for (const StemGrid& grid : impl_->grids) {
    const Row& row = impl_->layout->rows[grid.row];
    for (const GridStem& found : find_stems(grid, impl_->options)) {
      const LinePoint at = point_at(row.centreline, found.foot.x());
      const Eigen::Vector2d left(-at.direction.y(), at.direction.x());
      Stem stem;
      stem.row = row.number;
      stem.position = at.position + left * found.foot.y();
      const Eigen::Vector2d local = stem.position - low;
      if (local.minCoeff() < -kHair || local.maxCoeff() > impl_->tile.size_m + kHair) continue;
      stem.lean = at.direction * found.lean.x() + left * found.lean.y();
      stem.radius_m = found.radius_m, stem.top_m = found.top_m, stem.contrast = found.contrast;
      stem.upper_share = found.upper_share, stem.solidity = found.solidity;
      stems.push_back(stem);
    }
  }
  return stems;
}

}  // namespace rayfield::density
