#include "libdensity/echoes/echo_statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rayfield::density {
namespace {

constexpr double kUsualCosine = 0.8;  // of full echoes: leaves that face the lidar are found more easily

int level_of(double intensity) {
  if (intensity < 1) return 0;
  return std::min(EchoStatistics::kLevels - 1, static_cast<int>(8 * std::log2(intensity)));
}

std::size_t bin_of(double width_m) {
  const int bin = static_cast<int>(width_m / EchoStatistics::kWidthStepM);
  return static_cast<std::size_t>(std::clamp(bin, 0, EchoStatistics::kWidthBins - 1));
}

}  // namespace

void EchoStatistics::Stems::merge(const Stems& other) {
  full.add(other.full.count, other.full.intensity);
  for (std::size_t i = 0; i < histogram.size(); ++i) histogram[i] += other.histogram[i];
}

EchoStatistics::EchoStatistics() : histogram_(kIntensities, 0), pairs_(kLevels) {}

void EchoStatistics::add_echo(std::uint16_t intensity, double width_m) {
  all_[bin_of(width_m)].add(1, intensity);
  ++histogram_[intensity];
}

void EchoStatistics::add_ground_echo(std::uint16_t intensity, double cosine) {
  ground_[static_cast<std::size_t>(std::clamp(static_cast<int>(cosine * kCosines), 0, kCosines - 1))].add(1, intensity);
}

void EchoStatistics::add_stem_echo(std::uint16_t intensity, const OnStem& place) {
  Stems& stems = place.of_trunk ? trunks_ : posts_;
  if (place.is_full) stems.full.add(1, intensity);
  if (place.above_grass) ++stems.histogram[intensity];
}

AngleDependence EchoStatistics::ground_dependence() const {
  constexpr int kAslant = kCosines * 4 / 10, kMiddle = kCosines * 6 / 10, kSteep = kCosines * 8 / 10;  // 66°, 53°, 37°
  constexpr std::int64_t kEnough = 1000;
  constexpr double kLeavesDifferError = 0.1;
  std::array<Sum, 2> sums{};
  std::array<double, 2> cosine{};
  for (int bin = kAslant; bin < kCosines; ++bin) {
    if (bin >= kMiddle && bin < kSteep) continue;
    const auto side = static_cast<std::size_t>(bin >= kSteep ? 1 : 0);
    const Sum& sum = ground_[static_cast<std::size_t>(bin)];
    sums[side].add(sum.count, sum.intensity);
    cosine[side] += static_cast<double>(sum.count) * (bin + 0.5) / kCosines;
  }
  if (std::min(sums[0].count, sums[1].count) < kEnough) return {};
  for (const std::size_t side : {0, 1}) cosine[side] /= static_cast<double>(sums[side].count);
  const double slope = (sums[1].mean() - sums[0].mean()) / (cosine[1] - cosine[0]);
  const double at_leaves = sums[1].mean() - slope * (cosine[1] - kUsualCosine);
  if (!(at_leaves > 0)) return {};
  return {std::clamp(slope / at_leaves, -1.0, 2.0), kLeavesDifferError};
}

void EchoStatistics::add_pair(std::uint16_t first, std::uint16_t second, double distance_m, double delta_m, bool hit) {
  const int level = level_of(first);
  const int weaker = hit ? std::min(level, level_of(second)) : level;
  pairs_[level].add(distance_m, delta_m, hit, pairs_[weaker]);
}

void EchoStatistics::merge(const EchoStatistics& other) {
  for (std::size_t i = 0; i < kWidthBins; ++i) {
    all_[i].add(other.all_[i].count, other.all_[i].intensity);
  }
  for (std::size_t i = 0; i < kCosines; ++i) ground_[i].add(other.ground_[i].count, other.ground_[i].intensity);
  add_full_echoes(other.full_);
  add_mixed_echoes(other.mixed_);
  posts_.merge(other.posts_), trunks_.merge(other.trunks_);
  same_beam_beside_ += other.same_beam_beside_;
  for (std::size_t i = 0; i < histogram_.size(); ++i) histogram_[i] += other.histogram_[i];
  for (std::size_t i = 0; i < pairs_.size(); ++i) pairs_[i] += other.pairs_[i];
}

EchoStatistics::Sum EchoStatistics::wood() const {
  Sum sum = posts_.full;
  sum.add(trunks_.full.count, trunks_.full.intensity);
  return sum;
}

std::uint64_t EchoStatistics::echoes() const {
  return std::accumulate(histogram_.begin(), histogram_.end(), std::uint64_t{0});
}

LeafSizePairs EchoStatistics::pairs_from(double intensity) const {
  LeafSizePairs sum;
  for (int level = level_of(intensity); level < kLevels; ++level) sum += pairs_[level];
  return sum;
}

double strength_quantile(std::span<const std::uint32_t> histogram, double share) {
  double total = 0, below = 0;
  for (const std::uint32_t count : histogram) total += count;
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    const double count = histogram[i];
    if (below + count >= share * total && count > 0)
      return static_cast<double>(i) - 0.5 + (share * total - below) / count;
    below += count;
  }
  return 0;
}

}  // namespace rayfield::density
