#include "rayfield/experiments/beam.h"

#include "experiments/beam/wall.h"
#include "experiments/trials/trials.h"

namespace rayfield::experiments {
namespace {

using density::VoxelBlockDensity;
using density::VoxelBlockOptions;

/// Pulses that meet nothing end here, behind the wall.
double max_range_m(const BeamExperimentOptions& options) { return 4 * options.distance_m + options.height_m; }

LidarBeam beam_of(const BeamExperimentOptions& options, double diameter_m) {
  return {options.exit_share * diameter_m, (1 - options.exit_share) * diameter_m / options.distance_m, std::nullopt};
}

sim::SiteLidar lidar_of(const BeamExperimentOptions& options, double diameter_m, double detection_share) {
  const LidarBeam beam = beam_of(options, diameter_m);
  sim::SiteLidar lidar;
  lidar.max_range_m = max_range_m(options);
  lidar.beam_diameter_m = beam.diameter_m, lidar.divergence_mrad = 1000 * beam.divergence_rad;
  lidar.detection_share = detection_share;
  lidar.range_resolution_m = options.range_resolution_m;
  return lidar;
}

/// As `process` has them, but that all rays are there and none has to be left out.
VoxelBlockOptions estimator_options(const BeamExperimentOptions& options) {
  VoxelBlockOptions out;
  out.voxels.sure_return_m = 0;
  out.beam.range_resolution_m = options.range_resolution_m;
  return out;
}

double relative_error(const VoxelBlockDensity& found, const Wall& wall) {
  return found.area_m2 / wall.leaves.leaf_area_m2() - 1;
}

struct ThinSums {
  Moments known, measured;
  ThinSums& operator+=(const ThinSums& other) {
    known += other.known, measured += other.measured;
    return *this;
  }
};

Result<void> try_thin(const BeamExperimentOptions& options, double leaf_size_m2, const Wall& wall, ThinSums& sums) {
  const RayBatch rays = wall.leaves.scan(wall.pulses, lidar_of(options, 0, 1), options.seed);
  VoxelBlockOptions estimator = estimator_options(options);
  RAYFIELD_ASSIGN(const VoxelBlockDensity measured, estimate_voxel_block(wall.block, rays, {}, estimator));
  estimator.estimator.leaf_size_m2 = leaf_size_m2;
  RAYFIELD_ASSIGN(const VoxelBlockDensity known, estimate_voxel_block(wall.block, rays, {}, estimator));
  sums.known.add(relative_error(known, wall)), sums.measured.add(relative_error(measured, wall));
  return {};
}

struct BeamSums {
  Moments counted, known, measured, full_echo, found_share, found_leaf_size;
  std::uint64_t not_told = 0;
  BeamSums& operator+=(const BeamSums& other) {
    counted += other.counted, known += other.known, measured += other.measured;
    full_echo += other.full_echo, found_share += other.found_share, found_leaf_size += other.found_leaf_size;
    not_told += other.not_told;
    return *this;
  }
};

/// One scan, estimated three times.
Result<void> try_beam(const BeamExperimentOptions& options, const BeamCell& cell, const Wall& wall,
                      std::uint64_t scan_seed, BeamSums& sums) {
  const RayBatch rays =
      wall.leaves.scan(wall.pulses, lidar_of(options, cell.diameter_m, cell.detection_share), scan_seed);
  LidarBeam beam = beam_of(options, cell.diameter_m);
  VoxelBlockOptions estimator = estimator_options(options);
  RAYFIELD_ASSIGN(const VoxelBlockDensity measured, estimate_voxel_block(wall.block, rays, beam, estimator));
  estimator.beam.enabled = false;
  RAYFIELD_ASSIGN(const VoxelBlockDensity counted, estimate_voxel_block(wall.block, rays, beam, estimator));
  estimator.beam.enabled = true, estimator.beam.full_echo = sim::full_echo_of_random_leaves();
  estimator.estimator.leaf_size_m2 = cell.leaf_size_m2, beam.detection_share = cell.detection_share;
  RAYFIELD_ASSIGN(const VoxelBlockDensity known, estimate_voxel_block(wall.block, rays, beam, estimator));
  sums.counted.add(relative_error(counted, wall));
  if (!measured.echoes || !known.echoes) {  // too few: every echo has counted as a hit
    ++sums.not_told;
    return {};
  }
  sums.known.add(relative_error(known, wall));
  sums.measured.add(relative_error(measured, wall));
  sums.full_echo.add(measured.echoes->full_echo / sim::full_echo_of_random_leaves());
  sums.found_share.add(measured.echoes->detection_share / cell.detection_share);
  sums.found_leaf_size.add(measured.echoes->leaf_size_m2 / cell.leaf_size_m2);
  return {};
}

/// Walls of one density and leaf size are the same for all beams: seed of the trial alone.
std::uint64_t wall_seed(const BeamExperimentOptions& options, std::uint64_t trial) {
  return trial_random(options.seed, 0, trial).bits();
}

Result<ThinReference> run_thin(const BeamExperimentOptions& options, double density_m2_m3, double leaf_size_m2,
                               Progress& progress) {
  const auto trial = [&](std::uint64_t index, ThinSums& sums) -> Result<void> {
    RAYFIELD_ASSIGN(const Wall wall, build_wall(options, density_m2_m3, leaf_size_m2, wall_seed(options, index)));
    return try_thin(options, leaf_size_m2, wall, sums);
  };
  RAYFIELD_ASSIGN(const ThinSums sums,
                  sum_over_trials<ThinSums>(options.trials, 1, options.threads, {}, progress, trial));
  return ThinReference{density_m2_m3, leaf_size_m2, fitted_voxel_m(leaf_size_m2), sums.known.mean(),
                       sums.measured.mean()};
}

Result<void> run_cell(const BeamExperimentOptions& options, std::uint64_t number, BeamCell& cell, Progress& progress) {
  const auto trial = [&](std::uint64_t index, BeamSums& sums) -> Result<void> {
    RAYFIELD_ASSIGN(const Wall wall,
                    build_wall(options, cell.density_m2_m3, cell.leaf_size_m2, wall_seed(options, index)));
    return try_beam(options, cell, wall, trial_random(options.seed, 1 + number, index).bits(), sums);
  };
  RAYFIELD_ASSIGN(const BeamSums sums,
                  sum_over_trials<BeamSums>(options.trials, 1, options.threads, {}, progress, trial));
  cell.voxel_m = fitted_voxel_m(cell.leaf_size_m2);
  cell.counted = sums.counted.mean(), cell.known = sums.known.mean(), cell.measured = sums.measured.mean();
  cell.full_echo = sums.full_echo.mean(), cell.found_share = sums.found_share.mean();
  cell.found_leaf_size = sums.found_leaf_size.mean(), cell.not_told = sums.not_told;
  return {};
}

}  // namespace

Result<void> BeamExperimentOptions::validate() const {
  RAYFIELD_CHECK(check_ranges("diameters_m", diameters_m, 0.001, kWidestBeam_m));
  RAYFIELD_CHECK(check_ranges("leaf_sizes_m2", leaf_sizes_m2, 0.0005, 0.05));
  RAYFIELD_CHECK(check_ranges("detection_shares", detection_shares, 0.01, 0.9));
  RAYFIELD_CHECK(check_ranges("densities_m2_m3", densities_m2_m3, 0.1, 20));
  RAYFIELD_CHECK(check_range("exit_share", exit_share, 0, 1));
  RAYFIELD_CHECK(check_range("thickness_m", thickness_m, 0.1, 5));
  RAYFIELD_CHECK(check_range("length_m", length_m, 1, 50));
  RAYFIELD_CHECK(check_range("height_m", height_m, 0.3, 10));
  RAYFIELD_CHECK(check_range("distance_m", distance_m, 0.5 * thickness_m + 0.2, 20));
  RAYFIELD_CHECK(check_range("range_resolution_m", range_resolution_m, 0.005, 2));
  RAYFIELD_CHECK(check_range("fans", fans, 2, 1e5));
  return check_range("trials", static_cast<double>(trials), 2, 1e4);
}

Result<BeamResult> run_beam(const BeamExperimentOptions& options, Progress& progress) {
  RAYFIELD_CHECK(options.validate());
  BeamResult result;
  const std::size_t walls = options.densities_m2_m3.size() * options.leaf_sizes_m2.size();
  const std::size_t beams = options.detection_shares.size() * options.diameters_m.size();
  progress.stage("wide beams", options.trials * walls * (1 + beams), "walls");
  for (const double density_m2_m3 : options.densities_m2_m3)
    for (const double leaf_size_m2 : options.leaf_sizes_m2) {
      RAYFIELD_ASSIGN(const ThinReference thin, run_thin(options, density_m2_m3, leaf_size_m2, progress));
      result.thin.push_back(thin);
      for (const double share : options.detection_shares)
        for (const double diameter_m : options.diameters_m) {
          BeamCell cell{density_m2_m3, leaf_size_m2, share, diameter_m};
          RAYFIELD_CHECK(run_cell(options, result.cells.size(), cell, progress));
          result.cells.push_back(cell);
        }
    }
  return result;
}

}  // namespace rayfield::experiments
