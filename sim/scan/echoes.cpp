#include "sim/scan/echoes.h"

#include <algorithm>
#include <cmath>

namespace rayfield::sim {
namespace {

constexpr double kReferenceRange_m = 5;

Echo echo_of(std::span<const SubEcho> hits) {
  Echo echo;
  for (const SubEcho& hit : hits) {
    echo.range_m += hit.energy * hit.range_m;
    echo.energy += hit.energy;
    echo.strength += hit.strength;
  }
  echo.range_m /= echo.energy;
  return echo;
}

}  // namespace

double detectable_energy(const SiteLidar& lidar, double range_m) {
  if (lidar.detection_range_exponent == 0) return lidar.detection_share;
  return lidar.detection_share * std::pow(range_m / kReferenceRange_m, lidar.detection_range_exponent);
}

std::optional<Echo> beam_return(const SiteLidar& lidar, std::span<SubEcho> hits, double dither,
                                const std::function<bool(const Echo&)>& lost, std::vector<Echo>* behind) {
  const std::size_t wanted_behind = behind == nullptr ? 0 : static_cast<std::size_t>(lidar.echoes - 1);
  std::sort(hits.begin(), hits.end(), [](const SubEcho& a, const SubEcho& b) { return a.range_m < b.range_m; });
  std::optional<Echo> chosen;
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < hits.size(); ++begin) {
    end = std::max(end, begin);
    while (end < hits.size() && hits[end].range_m <= hits[begin].range_m + lidar.range_resolution_m) ++end;
    const Echo echo = echo_of(hits.subspan(begin, end - begin));
    if (echo.energy + dither < detectable_energy(lidar, echo.range_m)) continue;
    begin = end - 1;
    if (lost(echo)) continue;
    if (chosen && wanted_behind > 0) {
      const Echo& before = behind->empty() ? *chosen : behind->back();
      if (echo.range_m > before.range_m + lidar.range_resolution_m) behind->push_back(echo);
    } else if (!chosen || lidar.returns == ReturnMode::last || echo.energy > chosen->energy) {
      chosen = echo;
    }
    if (lidar.returns == ReturnMode::first && (wanted_behind == 0 || behind->size() == wanted_behind)) break;
  }
  return chosen;
}

}  // namespace rayfield::sim
