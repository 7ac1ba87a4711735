#include "libdensity/estimate/voxel_sums.h"

#include <algorithm>
#include <cmath>

#include "libdensity/echoes/echo_loss.h"

namespace rayfield::density {
namespace {

constexpr int kRounds = 3;
constexpr double kLeastPath = 0.1;  // of the path up to the echoes; echoes above a full one count as passed less behind

/// The path of a voxel's beams, those parts of them that ran on behind their echoes included.
double path_of(const VoxelCounters& v, const EchoCounters& e, double full_echo) {
  const auto behind = static_cast<double>(e.behind), taken = static_cast<double>(e.echo_behind) / full_echo;
  return std::max(kLeastPath * v.path_sides(), v.path_sides() + EchoCounters::kPathUnit * (behind - taken));
}

/// How dense a row is; paths in voxel sides.
struct RowDensities {
  double mean = 0;           ///< hits per path
  double around_echoes = 0;  ///< the same in the mean over its hits
};

/// R of a voxel.
double returned_in(const EchoCounters& e, double path_sides, double mean_density, const ReturnedShare& returned,
                   double leaf_side_m) {
  const double units = path_sides / EchoCounters::kPathUnit;
  if (!(units > 0) || !(leaf_side_m > 0)) return 1;
  const double width_m = EchoCounters::kWidthUnitM * static_cast<double>(e.width) / units;
  const double depth = EchoCounters::kDepthUnit * static_cast<double>(e.depth) / units;
  return returned(width_m / leaf_side_m, mean_density * depth);
}

VoxelSums wide_beam_sum(const VoxelCounters& v, const EchoCounters& e, double returned, const EchoModel& model) {
  const double share = v.hits > 0 ? static_cast<double>(e.echo) / (model.full_echo * v.hits) : 0;
  VoxelSums s;
  s.rays = v.rays;
  s.hits = v.hits * share;
  s.hits_squared = v.hits * share * share * (1 + model.echo_variation);
  s.path = returned * path_of(v, e, model.full_echo);
  s.hit_path = returned * share * v.hit_path_sides();
  s.potential = v.potential_sides();
  return s;
}

RowDensities densities_of(std::span<const VoxelSums> sums, std::size_t voxels) {
  std::vector<double> hits(voxels), path(voxels);
  for (std::size_t i = 0; i < sums.size(); ++i) hits[i % voxels] += sums[i].hits, path[i % voxels] += sums[i].path;
  double all_hits = 0, all_path = 0, weighted = 0;
  for (std::size_t k = 0; k < voxels; ++k) {
    all_hits += hits[k], all_path += path[k];
    if (path[k] > 0) weighted += hits[k] * hits[k] / path[k];
  }
  if (!(all_hits > 0) || !(all_path > 0)) return {};
  return {all_hits / all_path, weighted / all_hits};
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
                                      const CrossSection& section, const EchoModel& model) {
  const double leaf_side_m = std::sqrt(model.leaf_size_m2);
  std::vector<VoxelSums> sums(counters.size());
  RowDensities dense;
  for (int round = 0; round < kRounds; ++round) {
    const double row_path = dense.around_echoes * model.range_resolution_m / section.voxel_m;
    const ReturnedShare returned(model.detection_share, model.resolution_path > 0 ? model.resolution_path : row_path);
    for (std::size_t i = 0; i < counters.size(); ++i) {
      const VoxelCounters& v = counters[i];
      if (v.rays > 0)
        sums[i] = wide_beam_sum(v, echoes[i], returned_in(echoes[i], v.path_sides(), dense.mean, returned, leaf_side_m),
                                model);
    }
    if (round + 1 < kRounds) dense = densities_of(sums, section.voxels);
  }
  return sums;
}

}  // namespace rayfield::density
