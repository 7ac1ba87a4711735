#include "visits.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "gps_alignment.h"
#include "residuals.h"

namespace rayfield::slam {
namespace {

constexpr double kLinkSeconds = 5.0;
constexpr std::uint64_t kLinkMatches = 10;
constexpr double kStretchSeconds = 20.0;
constexpr std::size_t kLeastMatches = 100;  // of a stretch whose percentile counts
constexpr std::size_t kLeastStretches = 3;

double offset_of(const PoseTrack& track, std::span<const Surfel> surfels, const SurfelMatch& match) {
  return std::abs(surfel_offset(track, surfels[match.first], surfels[match.second]));
}

}  // namespace

double revisit_thickness(const PoseTrack& track, std::span<const Surfel> surfels,
                         std::span<const SurfelMatch> revisits) {
  std::vector<double> offsets;
  offsets.reserve(revisits.size());
  for (const SurfelMatch& m : revisits) offsets.push_back(offset_of(track, surfels, m));
  return 1.4826 * median_of(std::move(offsets));
}

std::uint64_t count_linked_visits(std::span<const Surfel> surfels, std::span<const SurfelMatch> revisits) {
  std::map<std::pair<int, int>, std::uint64_t> links;
  for (const SurfelMatch& m : revisits) {
    const int a = static_cast<int>(surfels[m.first].time_s / kLinkSeconds);
    const int b = static_cast<int>(surfels[m.second].time_s / kLinkSeconds);
    ++links[{std::min(a, b), std::max(a, b)}];
  }
  std::uint64_t linked = 0;
  for (const auto& [pair, count] : links) linked += count >= kLinkMatches;
  return linked;
}

VisitMisfit visit_misfit(const PoseTrack& track, std::span<const Surfel> surfels,
                         std::span<const SurfelMatch> revisits) {
  std::vector<std::vector<float>> offsets(static_cast<std::size_t>(track.end_s() / kStretchSeconds) + 1);
  for (const SurfelMatch& m : revisits) {
    const auto offset = static_cast<float>(offset_of(track, surfels, m));
    for (const std::uint32_t k : {m.first, m.second}) {
      const auto stretch = static_cast<std::size_t>(std::max(0.0, surfels[k].time_s) / kStretchSeconds);
      offsets[std::min(stretch, offsets.size() - 1)].push_back(offset);
    }
  }
  VisitMisfit out;
  std::vector<double> percentiles;
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    std::vector<float>& here = offsets[k];
    if (here.size() < kLeastMatches) continue;
    const auto at = here.begin() + static_cast<std::ptrdiff_t>(here.size() * 9 / 10);
    std::nth_element(here.begin(), at, here.end());
    percentiles.push_back(static_cast<double>(*at));
    if (percentiles.back() > out.worst_m)
      out.worst_m = percentiles.back(), out.worst_s = (static_cast<double>(k) + 0.5) * kStretchSeconds;
  }
  if (percentiles.size() >= kLeastStretches) out.typical_m = median_of(std::move(percentiles));
  return out;
}

}  // namespace rayfield::slam
