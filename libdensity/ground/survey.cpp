#include "libdensity/ground/survey.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libdensity/tiles/fixed_point.h"
#include "libdensity/tiles/rounding.h"

namespace rayfield::density {
namespace {

constexpr std::size_t kPassageStride = 8;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Adds to the entry of the same step, keeping the steps ascending; steps mostly arrive in order.
void add_path(std::vector<PathSum>& path, const PathSum& sum) {
  if (!path.empty() && path.back().step == sum.step) {
    path.back() += sum;
    return;
  }
  if (path.empty() || path.back().step < sum.step) {
    path.push_back(sum);
    return;
  }
  const auto it = std::lower_bound(path.begin(), path.end(), sum.step,
                                   [](const PathSum& a, std::int64_t step) { return a.step < step; });
  if (it->step == sum.step) {
    *it += sum;
  } else {
    path.insert(it, sum);
  }
}

}  // namespace

PathSum& PathSum::operator+=(const PathSum& more) {
  count += more.count;
  east += more.east, north += more.north, up += more.up;
  return *this;
}

std::span<const LowBin> TileSurvey::cell_bins(int ix, int iy) const {
  const std::size_t cell =
      static_cast<std::size_t>(iy) * static_cast<std::size_t>(cells) + static_cast<std::size_t>(ix);
  return std::span<const LowBin>(bins).subspan(bin_begin[cell], bin_begin[cell + 1] - bin_begin[cell]);
}

SurveyAccumulator::SurveyAccumulator(const tile::TileRef& tile, const SurveyOptions& options)
    : tile_(tile),
      options_(options),
      cells_(std::max(1, round_int(tile.size_m / options.ground_cell_m))),
      corner_(tile.corner()),
      bin_units_(std::max<std::int64_t>(1, fixed_from_metres(options.ground_bin_m))),
      first_time_s_(std::numeric_limits<double>::infinity()),
      last_time_s_(-std::numeric_limits<double>::infinity()),
      lowest_(std::numeric_limits<double>::infinity()),
      highest_(-std::numeric_limits<double>::infinity()) {
  const std::size_t n = static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_);
  bins_.resize(n * static_cast<std::size_t>(options.ground_bins));
  used_.resize(n);
  const int side = std::max(1, round_int(tile.size_m / options.coverage_cell_m));
  coverage_ = Grid2<std::uint8_t>(corner_, tile.size_m / side, side, side);
}

// Keeps the lowest `ground_bins` occupied bins of a cell. A bin that is pushed out can never belong to the lowest
// again, so the counts of those that remain are complete in whatever order points and partial results arrive.
void SurveyAccumulator::add_bin(std::size_t cell, const LowBin& bin) {
  const std::size_t capacity = static_cast<std::size_t>(options_.ground_bins);
  LowBin* begin = bins_.data() + cell * capacity;
  LowBin* end = begin + used_[cell];
  if (begin != end && end - begin == options_.ground_bins && bin.key > (end - 1)->key) return;
  LowBin* at = std::lower_bound(begin, end, bin.key, [](const LowBin& b, std::int32_t key) { return b.key < key; });
  if (at != end && at->key == bin.key) {
    at->count += bin.count;
    at->sum += bin.sum;
    return;
  }
  if (used_[cell] == capacity) {
    --end;
  } else {
    ++used_[cell];
  }
  std::move_backward(at, end, end + 1);
  *at = bin;
}

void SurveyAccumulator::add_hit(const Eigen::Vector3d& end) {
  ++hits_;
  lowest_ = std::min(lowest_, end.z());
  highest_ = std::max(highest_, end.z());
  const Eigen::Vector2d local = end.head<2>() - corner_;
  const double cell_m = tile_.size_m / cells_;
  const int ix = std::clamp(static_cast<int>(local.x() / cell_m), 0, cells_ - 1);
  const int iy = std::clamp(static_cast<int>(local.y() / cell_m), 0, cells_ - 1);
  const std::int64_t z = fixed_from_metres(end.z());
  const std::int64_t key = floor_div(z, bin_units_);
  add_bin(static_cast<std::size_t>(iy) * static_cast<std::size_t>(cells_) + static_cast<std::size_t>(ix),
          {static_cast<std::int32_t>(key), 1, z - key * bin_units_});
  const int cx = std::clamp(static_cast<int>(local.x() / coverage_.cell_m), 0, coverage_.nx - 1);
  const int cy = std::clamp(static_cast<int>(local.y() / coverage_.cell_m), 0, coverage_.ny - 1);
  coverage_.at(cx, cy) |= kCoverageHit;
}

void SurveyAccumulator::add_start(const Eigen::Vector3d& origin, double time_s) {
  ++starts_;
  add_path(path_, {static_cast<std::int64_t>(std::floor(time_s / options_.path_step_s)), 1,
                   fixed_from_metres(origin.x()), fixed_from_metres(origin.y()), fixed_from_metres(origin.z())});
}

void SurveyAccumulator::add_passage(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector2d step = (to - from).head<2>();
  const int n = static_cast<int>(step.norm() / (0.5 * coverage_.cell_m)) + 1;
  for (int i = 0; i <= n; ++i) {
    const Eigen::Vector2d p = from.head<2>() + step * (static_cast<double>(i) / n) - corner_;
    const int ix = floor_int(p.x() / coverage_.cell_m);
    const int iy = floor_int(p.y() / coverage_.cell_m);
    if (coverage_.contains(ix, iy)) coverage_.at(ix, iy) |= kCoveragePassed;
  }
}

void SurveyAccumulator::add(const tile::SegmentBatch& segments) {
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Eigen::Vector3d& entry = segments.entry[i];
    const Eigen::Vector3d& exit = segments.exit[i];
    if (!entry.allFinite() || !exit.allFinite()) continue;
    const std::uint8_t flags = segments.flags[i];
    ++segments_;
    first_time_s_ = std::min(first_time_s_, segments.time_s[i]);
    last_time_s_ = std::max(last_time_s_, segments.time_s[i]);
    if (flags & tile::kStartsHere) add_start(entry, segments.time_s[i]);
    if (flags & tile::kEndsHere) {
      ++ends_;
      if (flags & tile::kHit)
        add_hit(exit);
      else
        misses_.add(exit - entry);
    }
    if (i % kPassageStride == 0 && exit.z() < entry.z()) add_passage(entry, exit);
  }
}

void SurveyAccumulator::merge(const SurveyAccumulator& other) {
  const std::size_t capacity = static_cast<std::size_t>(options_.ground_bins);
  for (std::size_t cell = 0; cell < used_.size(); ++cell)
    for (std::size_t b = 0; b < other.used_[cell]; ++b) add_bin(cell, other.bins_[cell * capacity + b]);
  for (const PathSum& sum : other.path_) add_path(path_, sum);
  for (std::size_t i = 0; i < coverage_.values.size(); ++i) coverage_.values[i] |= other.coverage_.values[i];
  segments_ += other.segments_, starts_ += other.starts_, ends_ += other.ends_, hits_ += other.hits_;
  misses_ += other.misses_;
  first_time_s_ = std::min(first_time_s_, other.first_time_s_);
  last_time_s_ = std::max(last_time_s_, other.last_time_s_);
  lowest_ = std::min(lowest_, other.lowest_);
  highest_ = std::max(highest_, other.highest_);
}

TileSurvey SurveyAccumulator::finish() const {
  TileSurvey out;
  out.index = tile_.index;
  out.tile_size_m = tile_.size_m;
  out.path_step_s = options_.path_step_s;
  out.bin_m = metres_from_fixed(bin_units_);
  out.cells = cells_;
  out.bin_begin.reserve(used_.size() + 1);
  out.bin_begin.push_back(0);
  for (std::size_t cell = 0; cell < used_.size(); ++cell) {
    const LowBin* begin = bins_.data() + cell * static_cast<std::size_t>(options_.ground_bins);
    out.bins.insert(out.bins.end(), begin, begin + used_[cell]);
    out.bin_begin.push_back(static_cast<std::uint32_t>(out.bins.size()));
  }
  out.path = path_;
  out.coverage = coverage_;
  out.segments = segments_, out.starts = starts_, out.ends = ends_, out.hits = hits_;
  out.misses = misses_;
  out.first_time_s = segments_ ? first_time_s_ : 0;
  out.last_time_s = segments_ ? last_time_s_ : 0;
  out.lowest_hit_m = hits_ ? lowest_ : kNaN;
  out.highest_hit_m = hits_ ? highest_ : kNaN;
  return out;
}

}  // namespace rayfield::density
