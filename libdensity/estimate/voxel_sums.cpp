#include "libdensity/estimate/voxel_sums.h"

#include <algorithm>
#include <cmath>

#include "libdensity/echoes/echo_loss.h"

namespace rayfield::density {
namespace {

constexpr double kLeastPath = 0.1;  // of the path up to the echoes; echoes above a full one count as passed less behind

/// The path of a voxel's beams, those parts of them that ran on behind their echoes included.
double path_of(const VoxelCounters& v, const EchoCounters& e, double full_echo) {
  const auto behind = static_cast<double>(e.behind), taken = static_cast<double>(e.echo_behind) / full_echo;
  return std::max(kLeastPath * v.path_sides(), v.path_sides() + EchoCounters::kPathUnit * (behind - taken));
}

/// R of a voxel, `rate`: hits per path before.
double returned_in(const EchoCounters& e, double path_sides, double rate, const EchoModel& model, double leaf_side_m) {
  const double units = path_sides / EchoCounters::kPathUnit;
  if (!(units > 0) || !(leaf_side_m > 0)) return 1;
  const double width_m = EchoCounters::kWidthUnitM * static_cast<double>(e.width) / units;
  const double depth = EchoCounters::kDepthUnit * static_cast<double>(e.depth) / units;
  return returned_share(width_m / leaf_side_m, model.detection_share, rate * depth);
}

}  // namespace

std::vector<VoxelSums> thin_ray_sums(std::span<const VoxelCounters> counters) {
  std::vector<VoxelSums> sums;
  sums.reserve(counters.size());
  for (const VoxelCounters& v : counters) {
    const double hits = v.hits;
    sums.push_back({v.rays, hits, hits, v.path_sides(), v.hit_path_sides(), v.potential_sides()});
  }
  return sums;
}

std::vector<VoxelSums> wide_beam_sums(std::span<const VoxelCounters> counters, std::span<const EchoCounters> echoes,
                                      const EchoModel& model) {
  const double leaf_side_m = std::sqrt(model.leaf_area_m2);
  std::vector<VoxelSums> sums(counters.size());
  double rate = 0;
  for (const int round : {1, 2}) {
    double hits = 0, path = 0;
    for (std::size_t i = 0; i < counters.size(); ++i) {
      const VoxelCounters& v = counters[i];
      const EchoCounters& e = echoes[i];
      if (v.rays == 0) continue;
      const double share = v.hits > 0 ? static_cast<double>(e.echo) / (model.full_echo * v.hits) : 0;
      const double returned = returned_in(e, v.path_sides(), rate, model, leaf_side_m);
      VoxelSums& s = sums[i];
      s.rays = v.rays;
      s.hits = v.hits * share;
      s.hits_squared = v.hits * share * share * (1 + model.echo_variation);
      s.path = returned * path_of(v, e, model.full_echo);
      s.hit_path = returned * share * v.hit_path_sides();
      s.potential = v.potential_sides();
      hits += s.hits, path += s.path;
    }
    if (round == 1) rate = path > 0 ? hits / path : 0;
  }
  return sums;
}

}  // namespace rayfield::density
