#include "cli/simulation/simulation_needs.h"

namespace rayfield::cli {
namespace {

// Means of simulated vineyards. A log: ranges and intensities of a beam after compression, of a fixed scanner its
// points, and the other sensors; a cloud: rays that hit something or went up; the truth: two trajectories.
constexpr double kScanBytesPerBeam = 3.6, kPointBytesPerBeam = 14, kRaysPerBeam = 0.95, kCloudBytesPerRay = 48,
                 kTruthBytesPerSecond = 22e3;
constexpr double kProgram = 160e6, kBytesPerTriangle = 250;

double beams_per_second(const sim::Site& site) {
  return site.lidar.kind == sim::LidarKind::spinning
             ? site.spinning.rate_hz * site.spinning.beams
             : site.multi_beam.rate_hz * site.multi_beam.beams * site.multi_beam.azimuth_steps;
}

// Two triangles a leaf, beside what stands there without leaves.
double triangles_in_leaf(const sim::World& bare, double leaf_fraction) {
  const sim::Site& site = bare.site();
  const double leaf_m2 = (site.canopy.leaf_size_min_cm2 + site.canopy.leaf_size_max_cm2) / 2e4;
  const double leaves = site.canopy.leaf_area_m2_per_m * site.rows.length_m * site.rows.count * leaf_fraction / leaf_m2;
  return static_cast<double>(bare.triangle_count()) + 2 * leaves;
}

}  // namespace

Result<SimulationNeeds> simulation_needs(const sim::Site& site, const SimulationOutput& output, Progress& progress) {
  SimulationNeeds simulation;
  for (std::size_t index = 0; index < site.dates.size(); ++index) {
    sim::Site bare = site;
    bare.dates[index].leaf_fraction = 0;
    RAYFIELD_ASSIGN(const sim::World world, sim::build_world(bare, index, output.threads, progress));
    RAYFIELD_ASSIGN(const sim::Drive drive, sim::plan_drive(world));
    const double seconds = drive.duration_s(), beams = seconds * beams_per_second(site);
    double bytes = kTruthBytesPerSecond * seconds;
    if (output.log)
      bytes += (site.lidar.kind == sim::LidarKind::spinning ? kScanBytesPerBeam : kPointBytesPerBeam) * beams;
    if (output.rays) bytes += kRaysPerBeam * kCloudBytesPerRay * beams;
    const double memory = kProgram + kBytesPerTriangle * triangles_in_leaf(world, site.dates[index].leaf_fraction);
    simulation.duration_s += seconds;
    simulation.beams += static_cast<std::uint64_t>(beams);
    simulation.needs =
        simulation.needs + Needs{static_cast<std::uint64_t>(bytes), 0, static_cast<std::uint64_t>(memory)};
  }
  return simulation;
}

}  // namespace rayfield::cli
