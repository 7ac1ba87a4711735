#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace rayfield::density {

/// Wood meets a ray in few places; further ones (a ray along a line of posts) are merged into the last.
inline constexpr std::size_t kMaxGaps = 6;

/// Along a ray, m.
struct Interval {
  double from, to;
};

/// What remains of a ray after masked wood is taken out.
struct Gaps {
  std::array<Interval, kMaxGaps> gaps{};
  std::size_t count = 0;

  /// Keeps the gaps in order of their beginning.
  void insert(Interval gap) {
    if (count == kMaxGaps) {
      gaps[kMaxGaps - 1] = {std::min(gaps[kMaxGaps - 1].from, gap.from), std::max(gaps[kMaxGaps - 1].to, gap.to)};
      return;
    }
    std::size_t at = count++;
    for (; at > 0 && gaps[at - 1].from > gap.from; --at) gaps[at] = gaps[at - 1];
    gaps[at] = gap;
  }
  bool covers(double t) const {
    for (std::size_t i = 0; i < count; ++i)
      if (gaps[i].from <= t && t <= gaps[i].to) return true;
    return false;
  }
  /// The parts of 0…length outside the gaps, in order; returns how many.
  std::size_t pieces(double length, std::array<Interval, kMaxGaps + 1>& out) const {
    std::size_t n = 0;
    double from = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (gaps[i].from > from) out[n++] = {from, gaps[i].from};
      from = std::max(from, gaps[i].to);
    }
    if (from < length) out[n++] = {from, length};
    return n;
  }
};

}  // namespace rayfield::density
