#include "libdensity/echoes/echo_statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rayfield::density {
namespace {

int level_of(double intensity) {
  if (intensity < 1) return 0;
  return std::min(EchoStatistics::kLevels - 1, static_cast<int>(4 * std::log2(intensity)));
}

std::size_t bin_of(double width_m) {
  const int bin = static_cast<int>(width_m / EchoStatistics::kWidthStepM);
  return static_cast<std::size_t>(std::clamp(bin, 0, EchoStatistics::kWidthBins - 1));
}

}  // namespace

EchoStatistics::EchoStatistics() : histogram_(kIntensities, 0), pairs_(kLevels) {}

void EchoStatistics::add_echo(std::uint16_t intensity, double width_m) {
  all_[bin_of(width_m)].add(1, intensity);
  ++histogram_[intensity];
}

void EchoStatistics::add_inner_echo(std::uint16_t intensity, double width_m) {
  inner_[bin_of(width_m)].add(1, intensity);
}

void EchoStatistics::add_pair(std::uint16_t first, std::uint16_t second, double distance_m, double delta_m, bool hit) {
  const int level = level_of(first);
  const int weaker = hit ? std::min(level, level_of(second)) : level;
  pairs_[level].add(distance_m, delta_m, hit, pairs_[weaker]);
}

void EchoStatistics::merge(const EchoStatistics& other) {
  for (std::size_t i = 0; i < kWidthBins; ++i) {
    all_[i].add(other.all_[i].count, other.all_[i].intensity);
    inner_[i].add(other.inner_[i].count, other.inner_[i].intensity);
  }
  wood_echoes_ += other.wood_echoes_;
  for (std::size_t i = 0; i < histogram_.size(); ++i) histogram_[i] += other.histogram_[i];
  for (std::size_t i = 0; i < pairs_.size(); ++i) pairs_[i] += other.pairs_[i];
}

std::uint64_t EchoStatistics::echoes() const {
  return std::accumulate(histogram_.begin(), histogram_.end(), std::uint64_t{0});
}

LeafSizePairs EchoStatistics::pairs_from(double intensity) const {
  LeafSizePairs sum;
  for (int level = level_of(intensity); level < kLevels; ++level) sum += pairs_[level];
  return sum;
}

bool EchoRun::push(const Echo& echo) {
  const bool goes_on = length_ > 0 && std::abs(echo.range_m - last_[0].range_m) < kSurfaceStepM;
  length_ = goes_on ? std::min(length_ + 1, 5) : 1;
  std::copy_backward(last_.begin(), last_.end() - 1, last_.end());
  last_[0] = echo;
  return length_ == 5;
}

}  // namespace rayfield::density
