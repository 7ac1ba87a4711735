#include "experiments/beam/wall.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rayfield/sim/random.h"

namespace rayfield::experiments {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kBeamStep = kDegree * 2 / 3;    // between the beams of a fan, as of 286 over 190°: 2.3 cm at 2 m
constexpr double kWidestAzimuth = 50 * kDegree;  // of a fan, off the line across the wall
constexpr double kAboveM = 0.1;                  // fans reach so far over and under the wall
constexpr double kFanSeconds = 0.01;

/// Room for the rims of leaves around the box that holds their middles, and a voxel of empty space.
double margin_of(double leaf_size_m2, double voxel_m) { return 0.75 * std::sqrt(leaf_size_m2) + voxel_m; }

int voxels_over(double length_m, double voxel_m) { return static_cast<int>(std::ceil(length_m / voxel_m)); }

/// An upright fan of beams through the wall's middle plane at `along`, from the side `side` (−1 or 1).
void add_fan(const BeamExperimentOptions& options, double along, double azimuth, int side, double time_s,
             std::vector<sim::Pulse>& pulses) {
  const double middle_y = 0.5 * options.thickness_m, middle_z = 0.5 * options.height_m;
  const Eigen::Vector3d ahead(std::sin(azimuth), -side * std::cos(azimuth), 0);
  const Eigen::Vector3d origin =
      Eigen::Vector3d(along, middle_y, middle_z) - options.distance_m / std::cos(azimuth) * ahead;
  const double near_m = (options.distance_m - 0.5 * options.thickness_m) / std::cos(azimuth);
  const double reach = std::atan2(middle_z + kAboveM, near_m);
  const int beams = static_cast<int>(std::floor(reach / kBeamStep));
  for (int b = -beams; b <= beams; ++b) {
    const double elevation = b * kBeamStep;
    pulses.push_back({origin, std::cos(elevation) * ahead + std::sin(elevation) * Eigen::Vector3d::UnitZ(),
                      time_s + kFanSeconds * (b + beams) / (2 * beams + 1)});
  }
}

/// One pass on each side; fans go through random places of the wall in random directions.
std::vector<sim::Pulse> pulses_of(const BeamExperimentOptions& options, std::uint64_t seed) {
  sim::CounterRandom random(seed, sim::Stream::experiment);
  std::vector<sim::Pulse> pulses;
  for (int f = 0; f < options.fans; ++f) {
    const int side = f < options.fans / 2 ? -1 : 1;
    const double along = random.uniform(0, options.length_m);
    const double azimuth = random.uniform(-kWidestAzimuth, kWidestAzimuth);
    add_fan(options, along, azimuth, side, f * kFanSeconds, pulses);
  }
  return pulses;
}

}  // namespace

double fitted_voxel_m(double leaf_size_m2) {
  const density::VoxelFitOptions fit;
  const double side = std::clamp(fit.leaf_sides * std::sqrt(leaf_size_m2), fit.min_m, fit.max_m);
  return std::round(1000 * side) / 1000;
}

Result<Wall> build_wall(const BeamExperimentOptions& options, double density_m2_m3, double leaf_size_m2,
                        std::uint64_t seed) {
  const Eigen::Vector3d size(options.length_m, options.thickness_m, options.height_m);
  RAYFIELD_ASSIGN(sim::LeafBox leaves, sim::LeafBox::create({size, density_m2_m3, leaf_size_m2, seed}));
  density::VoxelBlock block;
  block.voxel_m = fitted_voxel_m(leaf_size_m2);
  const double margin = margin_of(leaf_size_m2, block.voxel_m);
  block.low_m = Eigen::Vector3d::Constant(-margin);
  block.n_along = voxels_over(size.x() + 2 * margin, block.voxel_m);
  block.n_across = voxels_over(size.y() + 2 * margin, block.voxel_m);
  block.n_up = voxels_over(size.z() + 2 * margin, block.voxel_m);
  return Wall{std::move(leaves), pulses_of(options, seed), block};
}

}  // namespace rayfield::experiments
