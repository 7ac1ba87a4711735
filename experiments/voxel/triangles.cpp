#include "rayfield/experiments/triangles.h"

#include "experiments/trials/trials.h"
#include "experiments/voxel/voxel_rays.h"

namespace rayfield::experiments {
namespace {

constexpr std::uint64_t kBatch = 64;

struct Errors {
  NormalisedError maximum_likelihood, debiased, unbiased;
  void add(const VoxelCounts& counts, double truth) {
    const VoxelDensities found = densities_of(counts);
    maximum_likelihood.add(found.maximum_likelihood, truth);
    debiased.add(found.debiased, truth);
    unbiased.add(found.unbiased, truth);
  }
};

/// By number of rays.
struct Sums {
  std::vector<Errors> errors;
  Sums& operator+=(const Sums& other) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      errors[i].maximum_likelihood += other.errors[i].maximum_likelihood;
      errors[i].debiased += other.errors[i].debiased;
      errors[i].unbiased += other.errors[i].unbiased;
    }
    return *this;
  }
};

TriangleCell cell_of(const LeafConfiguration& leaves, int rays, const Errors& errors) {
  return {leaves,
          rays,
          leaves.area_m2 / equilateral_area(leaves.side_m),
          errors.maximum_likelihood.mean(),
          errors.debiased.mean(),
          errors.unbiased.mean()};
}

/// Cells for `least` … `most` rays: the rays of a trial are looked at one after the other, and so cells of different
/// numbers of rays share leaves and rays.
Result<std::vector<TriangleCell>> run_cells(const TriangleOptions& options, const LeafConfiguration& leaves,
                                            std::uint64_t cell, int least, int most, Progress& progress) {
  const LeafPopulation population{options.voxel_m, leaves.side_m, leaves.area_m2, {}};
  const Sums zero{std::vector<Errors>(static_cast<std::size_t>(most - least + 1))};
  const auto trial = [&](std::uint64_t index, Sums& sums) -> Result<void> {
    sim::CounterRandom random = trial_random(options.seed, cell, index);
    std::vector<Triangle> triangles;
    grow_leaves(population, random, triangles);
    const double truth = true_density(triangles, options.voxel_m);
    VoxelCounts counts;
    for (int n = 1; n <= most; ++n) {
      counts.send(draw_chord(options.voxel_m, random), triangles);
      if (n >= least) sums.errors[static_cast<std::size_t>(n - least)].add(counts, truth);
    }
    return {};
  };
  RAYFIELD_ASSIGN(const Sums sums,
                  sum_over_trials<Sums>(options.trials, kBatch, options.threads, zero, progress, trial));
  std::vector<TriangleCell> cells;
  for (int n = least; n <= most; ++n)
    cells.push_back(cell_of(leaves, n, sums.errors[static_cast<std::size_t>(n - least)]));
  return cells;
}

}  // namespace

Result<void> TriangleOptions::validate() const {
  RAYFIELD_CHECK(check_range("voxel_m", voxel_m, 0.01, 1));
  RAYFIELD_CHECK(check_range("most_rays", most_rays, 2, 1000));
  RAYFIELD_CHECK(check_range("surface_rays", surface_rays, 2, 1000));
  for (const LeafConfiguration& c : configurations) {
    RAYFIELD_CHECK(check_range("configurations.side_m", c.side_m, 0.001, 1));
    RAYFIELD_CHECK(check_range("configurations.area_m2", c.area_m2, 1e-6, 10));
  }
  RAYFIELD_CHECK(check_ranges("sides_m", sides_m, 0.001, 1));
  RAYFIELD_CHECK(check_ranges("areas_m2", areas_m2, 1e-6, 10));
  return check_range("trials", static_cast<double>(trials), 2, 1e7);
}

Result<TriangleResult> run_triangles(const TriangleOptions& options, Progress& progress) {
  RAYFIELD_CHECK(options.validate());
  TriangleResult result;
  std::uint64_t cell = 0;
  const std::size_t cells = options.configurations.size() + options.sides_m.size() * options.areas_m2.size();
  progress.stage("triangles in a voxel", options.trials * cells, "trials");
  for (const LeafConfiguration& leaves : options.configurations) {
    RAYFIELD_ASSIGN(const auto row, run_cells(options, leaves, cell++, 2, options.most_rays, progress));
    result.few_rays.insert(result.few_rays.end(), row.begin(), row.end());
  }
  for (const double side_m : options.sides_m)
    for (const double area_m2 : options.areas_m2) {
      const int n = options.surface_rays;
      RAYFIELD_ASSIGN(const auto one, run_cells(options, {side_m, area_m2}, cell++, n, n, progress));
      result.surface.push_back(one.front());
    }
  return result;
}

}  // namespace rayfield::experiments
