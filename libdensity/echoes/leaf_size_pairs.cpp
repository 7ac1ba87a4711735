#include "libdensity/echoes/leaf_size_pairs.h"

#include <cmath>
#include <cstddef>

namespace rayfield::density {
namespace {

constexpr double kKnownBehindM = 0.1;  // rays that are cut off nearer tell nothing

template <std::size_t N>
void add_to(std::array<std::uint64_t, N>& sums, const std::array<std::uint64_t, N>& others) {
  for (std::size_t i = 0; i < N; ++i) sums[i] += others[i];
}

/// Sum over the depths from −kReachM + first·kDepthStepM on.
std::uint64_t sum_of(const LeafSizePairs::Depths& depths, int first, int last) {
  std::uint64_t sum = 0;
  for (int i = first; i < last; ++i) sum += depths[static_cast<std::size_t>(i)];
  return sum;
}

}  // namespace

LeafSizePairs& LeafSizePairs::operator+=(const LeafSizePairs& other) {
  add_to(beyond, other.beyond);
  for (std::size_t i = 0; i < rays.size(); ++i) add_to(rays[i], other.rays[i]), add_to(ends[i], other.ends[i]);
  return *this;
}

void LeafSizePairs::add(double distance_m, double delta_m, bool hit, LeafSizePairs& echoes) {
  const double bin = distance_m / kStepM, depth = (delta_m + kReachM) / kDepthStepM;
  if (!(bin < kBins) || !(depth >= 0) || (!hit && delta_m < kKnownBehindM)) return;
  const auto i = static_cast<std::size_t>(bin);
  if (!hit || depth >= kDepths) {
    ++beyond[i];
    return;
  }
  ++rays[i][static_cast<std::size_t>(depth)];
  ++echoes.ends[i][static_cast<std::size_t>(depth)];
}

double ends_per_metre_behind(const LeafSizePairs& pairs, double otherwise) {
  constexpr std::size_t kNear = 8;  // steps of distance
  constexpr int kFrom = LeafSizePairs::kDepths / 2 + 5, kTo = LeafSizePairs::kDepths / 2 + 15;
  constexpr std::uint64_t kLeast = 200;
  std::uint64_t past = 0, ends = 0;
  for (std::size_t i = 0; i < kNear; ++i) {
    past += pairs.beyond[i] + sum_of(pairs.rays[i], kFrom, LeafSizePairs::kDepths);
    ends += sum_of(pairs.rays[i], kFrom, kTo);
  }
  if (past < kLeast) return otherwise;
  return static_cast<double>(ends) / static_cast<double>(past) / ((kTo - kFrom) * LeafSizePairs::kDepthStepM);
}

PairCounts counts_of(const LeafSizePairs& pairs, double window_m) {
  constexpr int kMiddle = LeafSizePairs::kDepths / 2;
  const auto steps = static_cast<int>(std::lround(window_m / LeafSizePairs::kDepthStepM));
  PairCounts out;
  for (std::size_t i = 0; i < pairs.rays.size(); ++i) {
    out.near[i] = pairs.beyond[i] + sum_of(pairs.rays[i], kMiddle - 2 * steps, LeafSizePairs::kDepths);
    out.front[i] = sum_of(pairs.ends[i], kMiddle - 2 * steps, kMiddle - steps);
    out.same[i] = sum_of(pairs.ends[i], kMiddle - steps, kMiddle + steps);
    out.behind[i] = sum_of(pairs.ends[i], kMiddle + steps, kMiddle + 2 * steps);
  }
  return out;
}

}  // namespace rayfield::density
