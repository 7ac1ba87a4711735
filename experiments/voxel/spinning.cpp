#include "rayfield/experiments/spinning.h"

#include <cmath>
#include <numbers>

#include "experiments/trials/trials.h"
#include "experiments/voxel/voxel_rays.h"

namespace rayfield::experiments {
namespace {

constexpr std::uint64_t kBatch = 64;

struct Sums {
  NormalisedError debiased, unbiased;
  Moments infinitesimal;
  Sums& operator+=(const Sums& other) {
    debiased += other.debiased, unbiased += other.unbiased, infinitesimal += other.infinitesimal;
    return *this;
  }
};

/// Horizontal, 0 … `widest_rad` from x.
Eigen::Vector3d draw_direction(double widest_rad, sim::CounterRandom& random) {
  const double angle = random.uniform(0, widest_rad);
  return {std::cos(angle), std::sin(angle), 0};
}

Result<SpinningCell> run_cell(const SpinningOptions& options, const LeafNormals& normals, double widest_rad,
                              std::uint64_t cell, Progress& progress) {
  const LeafPopulation population{options.voxel_m, options.leaf_side_m, options.leaf_area_m2, normals};
  const auto trial = [&](std::uint64_t index, Sums& sums) -> Result<void> {
    sim::CounterRandom random = trial_random(options.seed, cell, index);
    std::vector<Triangle> leaves;
    grow_leaves(population, random, leaves);
    VoxelCounts counts;
    for (int i = 0; i < options.rays; ++i) {
      const Eigen::Vector3d direction = draw_direction(widest_rad, random);
      counts.send(draw_parallel_chord(direction, options.voxel_m, random), leaves);
      sums.infinitesimal.add(2 * std::abs(draw_normal(normals, random).dot(direction)) - 1);
    }
    const double truth = true_density(leaves, options.voxel_m);
    const VoxelDensities found = densities_of(counts);
    sums.debiased.add(found.debiased, truth), sums.unbiased.add(found.unbiased, truth);
    return {};
  };
  RAYFIELD_ASSIGN(const Sums sums, sum_over_trials<Sums>(options.trials, kBatch, options.threads, {}, progress, trial));
  return SpinningCell{sums.debiased.mean(), sums.unbiased.mean(), sums.infinitesimal.mean()};
}

}  // namespace

Result<void> SpinningOptions::validate() const {
  RAYFIELD_CHECK(check_range("voxel_m", voxel_m, 0.01, 1));
  RAYFIELD_CHECK(check_range("leaf_side_m", leaf_side_m, 0.001, 1));
  RAYFIELD_CHECK(check_range("leaf_area_m2", leaf_area_m2, 1e-6, 10));
  RAYFIELD_CHECK(check_range("rays", rays, 2, 1000));
  RAYFIELD_CHECK(check_range("widest_angle_deg", widest_angle_deg, 0, 90));
  return check_range("trials", static_cast<double>(trials), 2, 1e7);
}

// The paper's trials are as unlike each other as ours, so that its standard error is √(trials/400) times ours.
double paper_deviations(double paper, const Mean& simulated, std::uint64_t trials) {
  const double more = static_cast<double>(trials) / kPaperSpinningTrials;
  return (paper - simulated.value) / (simulated.standard_error * std::sqrt(1 + more));
}

Result<SpinningResult> run_spinning(const SpinningOptions& options, Progress& progress) {
  RAYFIELD_CHECK(options.validate());
  const double widest_rad = options.widest_angle_deg * std::numbers::pi / 180;
  SpinningResult result;
  std::uint64_t cell = 0;
  progress.stage("trawling and spinning lidar", options.trials * kPaperSpinning.size() * 4, "trials");
  for (const SpinningFigure& figure : kPaperSpinning) {
    SpinningRow row;
    row.eccentricity = {figure.eccentricity[0], figure.eccentricity[1], figure.eccentricity[2]};
    row.paper_trawling = figure.trawling_percent / 100, row.paper_spinning = figure.spinning_percent / 100;
    for (const NormalBody body : {NormalBody::sphere, NormalBody::cube}) {
      const LeafNormals normals{row.eccentricity, body};
      const auto i = static_cast<std::size_t>(body);
      RAYFIELD_ASSIGN(row.trawling[i], run_cell(options, normals, 0, cell++, progress));
      RAYFIELD_ASSIGN(row.spinning[i], run_cell(options, normals, widest_rad, cell++, progress));
    }
    result.rows.push_back(row);
  }
  return result;
}

}  // namespace rayfield::experiments
