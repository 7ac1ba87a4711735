#include "formats/sensor_log/first_echoes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace rayfield::formats {
namespace {

/// Under no_return = max_range, ranges this close to it count as none: cartesian points round.
constexpr double kMaxRangeShare = 1.0 - 1e-4;
/// Closer to each other, echoes are one that was sent twice: lidars that always send two repeat a single one.
constexpr float kSameEcho_m = 0.01F;
/// Beams at one time are further apart (half of 0.1° and more), and coordinates in millimetres round less.
constexpr float kSameBeam_rad = 0.8e-3F;
/// No lidar reports more echoes of a beam, or sends more beams at a time at one height.
constexpr std::size_t kMostEchoes = 16, kMostBeside = 256;

/// Whether a ring has two points of one time. Within a ring points come in the order of time but for those.
bool any_time_twice(const std::vector<CloudPoint>& points) {
  std::vector<float> last_s;
  for (const CloudPoint& point : points) {
    if (point.ring >= last_s.size())
      last_s.resize(std::size_t{point.ring} + 1, -std::numeric_limits<float>::infinity());
    if (point.time_offset_s <= last_s[point.ring]) return true;
    last_s[point.ring] = point.time_offset_s;
  }
  return false;
}

/// Of a point: open until its beam is known.
enum class Fate : std::uint8_t { open, kept, dropped };

/// Points of one ring and time, by number, those without a place last and the others by the z of their directions, then
/// by x.
class SameTime {
 public:
  SameTime(const std::vector<CloudPoint>& points, const Rig::Lidar& lidar, std::vector<Fate>& fates)
      : points_(points), lidar_(lidar), fates_(fates) {}

  /// Returns the later echoes that were dropped.
  std::uint64_t thin(std::span<const std::size_t> group, bool has_rings) {
    const auto gaps = std::find_if(group.begin(), group.end(), [&](std::size_t i) { return !points_[i].placed(); });
    const std::span<const std::size_t> placed(group.begin(), gaps);
    std::uint64_t later = 0, beams = 0;
    for (std::size_t k = 0; k < placed.size(); ++k)
      if (fates_[placed[k]] == Fate::open) later += thin_beam(placed.subspan(k)), ++beams;
    // One beam, or none: its missing echoes are no shots of their own.
    if (has_rings && beams <= 1)
      for (const std::size_t gap : group.subspan(placed.size() + (beams == 0 ? 1 : 0))) fates_[gap] = Fate::dropped;
    return later;
  }

 private:
  bool same_beam(std::size_t a, std::size_t b) const {
    return (points_[a].direction - points_[b].direction).squaredNorm() < kSameBeam_rad * kSameBeam_rad;
  }
  /// `from`: the first point of a beam and what follows it.
  std::uint64_t thin_beam(std::span<const std::size_t> from) {
    std::array<std::size_t, kMostEchoes> echoes{};
    std::array<float, kMostEchoes> range_m{};
    std::size_t count = 0;
    for (const std::size_t i : from.first(std::min(from.size(), kMostBeside))) {
      if (count == kMostEchoes || points_[i].direction.z() > points_[from[0]].direction.z() + kSameBeam_rad) break;
      if (fates_[i] == Fate::open && same_beam(from[0], i)) echoes[count] = i, range_m[count++] = points_[i].range_m;
    }
    const FirstEcho first = *first_echo(std::span(range_m).first(count), lidar_);
    for (std::size_t k = 0; k < count; ++k) fates_[echoes[k]] = k == first.index ? Fate::kept : Fate::dropped;
    return first.later;
  }

  const std::vector<CloudPoint>& points_;
  const Rig::Lidar& lidar_;
  std::vector<Fate>& fates_;
};

}  // namespace

RangeKind kind_of_range(float range_m, const Rig::Lidar& lidar) {
  const auto range = static_cast<double>(range_m);
  const bool none = lidar.no_return == NoReturn::zero        ? range == 0.0
                    : lidar.no_return == NoReturn::max_range ? range >= lidar.max_range_m * kMaxRangeShare
                                                             : false;
  if (none || range > lidar.max_range_m) return RangeKind::none;
  if (std::isnan(range) || (range < 0 && std::isfinite(range))) return RangeKind::invalid;
  return range < lidar.min_range_m ? RangeKind::too_close : RangeKind::returned;
}

std::optional<FirstEcho> first_echo(std::span<const float> range_m, const Rig::Lidar& lidar) {
  if (range_m.empty()) return std::nullopt;
  if (range_m.size() == 1) return FirstEcho{};
  // A return before all else, the nearest one; what is too close before nothing, since the beam met it.
  const auto rank = [&](std::size_t i) {
    switch (kind_of_range(range_m[i], lidar)) {
      case RangeKind::returned:
        return std::pair(0, range_m[i]);
      case RangeKind::too_close:
        return std::pair(1, 0.0F);
      case RangeKind::none:
        return std::pair(2, 0.0F);
      case RangeKind::invalid:
        break;
    }
    return std::pair(3, 0.0F);
  };
  std::vector<std::size_t> order(range_m.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  FirstEcho first{order.front(), 0};
  for (std::size_t k = 1; k < order.size() && rank(order[k]).first == 0; ++k)
    if (range_m[order[k]] > range_m[order[k - 1]] + kSameEcho_m) ++first.later;
  return first;
}

std::uint64_t keep_first_echoes(std::vector<CloudPoint>& points, bool has_rings, const Rig::Lidar& lidar) {
  if (!any_time_twice(points)) return 0;
  struct Key {
    std::uint16_t ring;
    bool gap;
    float time_s, z, x;
    std::uint32_t number;
    auto tied() const { return std::tie(ring, time_s, gap, z, x, number); }
  };
  std::vector<Key> keys(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const CloudPoint& p = points[i];
    keys[i] = {p.ring, !p.placed(), p.time_offset_s, p.direction.z(), p.direction.x(), static_cast<std::uint32_t>(i)};
  }
  std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) { return a.tied() < b.tied(); });
  std::vector<std::size_t> order;
  order.reserve(points.size());
  for (const Key& key : keys) order.push_back(key.number);
  std::vector<Fate> fates(points.size(), Fate::open);
  SameTime same_time(points, lidar, fates);
  std::uint64_t later = 0;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    const CloudPoint& p = points[order[begin]];
    for (end = begin + 1; end < order.size() && points[order[end]].ring == p.ring &&
                          points[order[end]].time_offset_s == p.time_offset_s;)
      ++end;
    if (end - begin > 1) later += same_time.thin(std::span(order).subspan(begin, end - begin), has_rings);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (fates[i] != Fate::dropped) points[kept++] = points[i];
  points.resize(kept);
  return later;
}

}  // namespace rayfield::formats
