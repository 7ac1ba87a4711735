#include "libdensity/voxels/canopy_profile.h"

#include <algorithm>
#include <cmath>

#include "libdensity/layout/row_locator.h"

namespace rayfield::density {
namespace {

constexpr double kBin = 0.02;  // m

double half_width(const RowLayout& layout, const RowSegmentOptions& options) {
  return layout.spacing_m > 0 ? std::min(0.5 * layout.spacing_m, 3.0) : options.lone_half_width_m;
}

}  // namespace

struct CanopyProfileAccumulator::Impl {
  const RowLayout* layout;
  const GroundModel* ground;
  RowLocator locator;
  CanopyProfile profile;
  double max_height_m;
};

CanopyProfileAccumulator::CanopyProfileAccumulator(const tile::TileRef& tile, const RowLayout& layout,
                                                   const GroundModel& ground, const RowSegmentOptions& options)
    : impl_(new Impl{
          &layout, &ground, RowLocator(layout, tile, 0, half_width(layout, options)), {}, options.max_height_m}) {
  CanopyProfile& profile = impl_->profile;
  profile.bin_m = kBin;
  profile.half_width_m = half_width(layout, options);
  profile.up_min_m = options.up_min_m;
  const std::size_t n_across = static_cast<std::size_t>(std::ceil(2 * profile.half_width_m / kBin));
  const std::size_t n_up = static_cast<std::size_t>(std::ceil((options.max_height_m - options.up_min_m) / kBin));
  for (const auto& interval : impl_->locator.intervals()) {
    const int number = layout.rows[interval.row].number;
    profile.across[number].assign(n_across, 0);
    profile.up[number].assign(n_up, 0);
  }
}

CanopyProfileAccumulator::~CanopyProfileAccumulator() = default;
CanopyProfileAccumulator::CanopyProfileAccumulator(const CanopyProfileAccumulator& other)
    : impl_(new Impl(*other.impl_)) {}
CanopyProfileAccumulator::CanopyProfileAccumulator(CanopyProfileAccumulator&&) noexcept = default;
CanopyProfileAccumulator& CanopyProfileAccumulator::operator=(CanopyProfileAccumulator&&) noexcept = default;

void CanopyProfileAccumulator::add(const tile::HitBatch& hits) {
  CanopyProfile& profile = impl_->profile;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if ((hits.flags[i] & tile::kEndsHere) == 0) continue;
    const Eigen::Vector3d& p = hits.end[i];
    const auto place = impl_->locator.locate(p.head<2>());
    if (!place) continue;
    const auto ground = impl_->ground->height(p.x(), p.y());
    if (!ground) continue;
    const double up = p.z() - *ground;
    if (up < profile.up_min_m || up >= impl_->max_height_m) continue;
    const int number = impl_->layout->rows[place->row].number;
    auto& across = profile.across[number];
    auto& ups = profile.up[number];
    const std::size_t a =
        std::min(across.size() - 1, static_cast<std::size_t>((place->across_m + profile.half_width_m) / kBin));
    const std::size_t u = std::min(ups.size() - 1, static_cast<std::size_t>((up - profile.up_min_m) / kBin));
    ++across[a], ++ups[u];
  }
}

void add_profile(CanopyProfile& total, const CanopyProfile& tile) {
  if (total.across.empty()) {
    total = tile;
    return;
  }
  const auto add = [](std::map<int, std::vector<std::int64_t>>& into,
                      const std::map<int, std::vector<std::int64_t>>& more) {
    for (const auto& [row, counts] : more) {
      auto& mine = into[row];
      if (mine.size() < counts.size()) mine.resize(counts.size(), 0);
      for (std::size_t i = 0; i < counts.size(); ++i) mine[i] += counts[i];
    }
  };
  add(total.across, tile.across), add(total.up, tile.up);
}

bool CanopyProfileAccumulator::empty() const { return impl_->locator.intervals().empty(); }

void CanopyProfileAccumulator::merge(const CanopyProfileAccumulator& other) {
  add_profile(impl_->profile, other.impl_->profile);
}

const CanopyProfile& CanopyProfileAccumulator::finish() const { return impl_->profile; }

}  // namespace rayfield::density
