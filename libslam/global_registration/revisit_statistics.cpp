#include "libslam/global_registration/revisit_statistics.h"

#include <algorithm>
#include <cmath>

#include "libslam/solver/residuals.h"
#include "rayfield/core/median.h"

namespace rayfield::slam {
namespace {

constexpr double kLinkSeconds = 5.0;
constexpr std::uint32_t kLinkMatches = 10;
constexpr double kSectionSeconds = 20.0;
constexpr std::uint64_t kMinMatches = 100;  // of a section whose percentile counts
constexpr std::size_t kMinSections = 3;
constexpr double kSmallestOffset_m = 1e-6, kBinRatio = 1.04;

}  // namespace

void LogHistogram::add(double offset_m) {
  const double bin = std::log(std::max(offset_m, kSmallestOffset_m) / kSmallestOffset_m) / std::log(kBinRatio);
  ++bins_[std::min(static_cast<std::size_t>(bin), kBins - 1)];
  ++count_;
}

double LogHistogram::quantile(double share) const {
  const double wanted = share * static_cast<double>(count_);
  double below = 0;
  for (std::size_t k = 0; k < kBins; ++k) {
    const double here = bins_[k];
    if (here > 0 && below + here >= wanted)
      return kSmallestOffset_m * std::pow(kBinRatio, static_cast<double>(k) + (wanted - below) / here);
    below += here;
  }
  return 0;
}

RevisitStatistics::RevisitStatistics(double duration_s)
    : sections_(static_cast<std::size_t>(duration_s / kSectionSeconds) + 1) {}

void RevisitStatistics::add(const PoseTrack& track, std::span<const Surfel> surfels,
                            std::span<const SurfelMatch> revisits) {
  for (const SurfelMatch& m : revisits) {
    const Surfel &first = surfels[m.first], &second = surfels[m.second];
    const double offset = std::abs(surfel_offset(track, first, second));
    all_.add(offset);
    for (const Surfel* s : {&first, &second}) {
      const auto section = static_cast<std::size_t>(std::max(0.0, s->time_s) / kSectionSeconds);
      sections_[std::min(section, sections_.size() - 1)].add(offset);
    }
    const int a = static_cast<int>(first.time_s / kLinkSeconds), b = static_cast<int>(second.time_s / kLinkSeconds);
    ++links_[{std::min(a, b), std::max(a, b)}];
  }
}

std::uint64_t RevisitStatistics::linked_sections() const {
  return static_cast<std::uint64_t>(
      std::count_if(links_.begin(), links_.end(), [](const auto& link) { return link.second >= kLinkMatches; }));
}

RevisitMisfit RevisitStatistics::misfit() const {
  RevisitMisfit out;
  std::vector<double> percentiles;
  for (std::size_t k = 0; k < sections_.size(); ++k) {
    if (sections_[k].count() < kMinMatches) continue;
    percentiles.push_back(sections_[k].quantile(0.9));
    if (percentiles.back() > out.worst_m)
      out.worst_m = percentiles.back(), out.worst_s = (static_cast<double>(k) + 0.5) * kSectionSeconds;
  }
  if (percentiles.size() >= kMinSections) out.typical_m = median_of(std::move(percentiles));
  return out;
}

}  // namespace rayfield::slam
