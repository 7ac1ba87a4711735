#include "experiments/voxel/voxel_rays.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "rayfield/density/estimator.h"

namespace rayfield::experiments {
namespace {

constexpr double kG = 2;  // density over λ, of leaves of all directions

/// A line at an even place of the disc that the voxel's circumscribed sphere fills across the direction; nothing if it
/// misses the voxel.
std::optional<Chord> try_chord(const Eigen::Vector3d& direction, double voxel_m, sim::CounterRandom& random) {
  const double radius = 0.5 * std::numbers::sqrt3 * voxel_m * std::sqrt(random.uniform());
  const double turn = random.uniform(0, 2 * std::numbers::pi);
  const Eigen::Vector3d u = direction.unitOrthogonal(), v = direction.cross(u);
  const Eigen::Vector3d through =
      Eigen::Vector3d::Constant(0.5 * voxel_m) + radius * (std::cos(turn) * u + std::sin(turn) * v);
  double from = -2 * voxel_m, to = 2 * voxel_m;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) {
      if (through[axis] < 0 || through[axis] > voxel_m) return std::nullopt;
      continue;
    }
    double first = -through[axis] / direction[axis], last = (voxel_m - through[axis]) / direction[axis];
    if (first > last) std::swap(first, last);
    from = std::max(from, first), to = std::min(to, last);
  }
  if (!(to > from)) return std::nullopt;
  return Chord{through + from * direction, direction, to - from};
}

}  // namespace

Chord draw_parallel_chord(const Eigen::Vector3d& direction, double voxel_m, sim::CounterRandom& random) {
  for (;;)
    if (const auto chord = try_chord(direction, voxel_m, random)) return *chord;
}

Chord draw_chord(double voxel_m, sim::CounterRandom& random) {
  for (;;) {
    const Eigen::Vector3d direction = draw_normal({}, random);
    if (const auto chord = try_chord(direction, voxel_m, random)) return *chord;
  }
}

void VoxelCounts::send(const Chord& chord, std::span<const Triangle> leaves) {
  double x = chord.length_m;
  for (const Triangle& leaf : leaves) {
    const double distance = distance_to(leaf, chord.entry, chord.direction);
    if (distance >= 0 && distance < x) x = distance;
  }
  ++rays, path_m += x;
  if (x < chord.length_m) ++hits, hit_path_m += x;
}

VoxelDensities densities_of(const VoxelCounts& c) {
  const auto hits = static_cast<double>(c.hits);
  return {kG * hits / c.path_m, density::estimate_paper(c.rays, c.hits, c.path_m).density,
          kG * density::unbiased_rate(hits, c.path_m, c.hit_path_m)};
}

double true_density(std::span<const Triangle> leaves, double voxel_m) {
  double area = 0;
  for (const Triangle& leaf : leaves) area += area_inside(leaf, voxel_m);
  return area / (voxel_m * voxel_m * voxel_m);
}

}  // namespace rayfield::experiments
