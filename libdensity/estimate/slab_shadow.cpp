#include "libdensity/estimate/slab_shadow.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "libdensity/tiles/rounding.h"
#include "libdensity/tiles/uniform.h"

namespace rayfield::density {
namespace {

constexpr int kSamples = 20000;
constexpr int kSteps = 16;     // of a shadow, per voxel side
constexpr int kReach = 3;      // voxels off the hit that share a slab with it, or with one that does
constexpr double kVoxels = 9;  // of a slab
constexpr double kAzimuth = std::numbers::pi / 3, kElevation = std::numbers::pi / 9;

/// Of the slabs that a voxel is part of, as a share: those that hold the voxel `along` and `up` from it, too.
double common(int along, int up) { return std::max(0, 3 - std::abs(along)) * std::max(0, 3 - std::abs(up)) / 9.0; }

/// Mean of common() over a slab.
double common_of_slab(int along, int up) {
  double sum = 0;
  for (int a = along - 1; a <= along + 1; ++a)
    for (int u = up - 1; u <= up + 1; ++u) sum += common(a, u);
  return sum / kVoxels;
}

/// By how much a density rises for potential path lost in a voxel, relative to what the voxel has.
struct Effect {
  double in_front;  ///< lost to parts of the leaf outside that voxel, on the way to it
  double inside;    ///< lost behind parts of the leaf in that voxel
};

/// In the voxel `along` and `up` from that of the hit, in one layer with it. With δ lost in front, σ inside, bars for
/// means over slabs, and the hit's voxel i: w = (1 + δ/2 + δ̄/2)/2P and D = ½Σ(1 − δ/2 + δ̄/2 − σ) make the density
/// 1 + δᵢ/2 + δ̄ᵢ/2 + the mean over its slabs of (δ̄ − δ̿)/2 + σ̄. leaf_shadow() has δᵢ/2 and what σᵢ adds to σ̄.
Effect effect_at(int along, int up) {
  const bool hit = along == 0 && up == 0, same_slab = std::abs(along) <= 1 && std::abs(up) <= 1;
  const double in_front = (same_slab ? 1.0 : 0.0) / kVoxels + (common(along, up) - common_of_slab(along, up)) / kVoxels;
  return {in_front / 2, hit ? 0 : common(along, up) / kVoxels};
}

}  // namespace

double slab_shadow(double area_m2, double voxel_m) {
  if (!(area_m2 > 0) || !(voxel_m > 0)) return 0;
  constexpr int kSide = 2 * kReach + 1;
  std::array<Effect, kSide * kSide> effects{};
  for (int a = -kReach; a <= kReach; ++a)
    for (int u = -kReach; u <= kReach; ++u)
      effects[static_cast<std::size_t>((a + kReach) * kSide + u + kReach)] = effect_at(a, u);
  const double side = std::sqrt(area_m2) / voxel_m;  // in voxels, as all below
  Uniform uniform(20211001);
  double lost = 0, hits = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double z = uniform.between(-1, 1), turn = uniform.between(-std::numbers::pi, std::numbers::pi);
    const Eigen::Vector3d normal(std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z);
    const double azimuth = uniform.between(-kAzimuth, kAzimuth), elevation = uniform.between(-kElevation, kElevation);
    const Eigen::Vector3d ray(std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth),
                              std::sin(elevation));  // along, across, up
    const Eigen::Vector3d axis_u = normal.unitOrthogonal(), axis_v = normal.cross(axis_u);
    const Eigen::Vector3d hit(uniform(), uniform(), uniform());
    const double u = uniform() - uniform(), v = uniform() - uniform();
    const Eigen::Vector3d caster = hit + side * (u * axis_u + v * axis_v);  // another point of the leaf
    const double cosine = std::abs(normal.dot(ray));                        // hits are as frequent, and shadows as wide
    hits += cosine;
    // The part of the shadow in the slab's layer, 0 ≤ across < 1; rays run across.
    const double from = std::max(0.0, -caster.y() / ray.y()), to = (1 - caster.y()) / ray.y();
    const int steps = ceil_int((to - from) * kSteps);
    if (steps <= 0) continue;
    const double step = (to - from) / steps;
    const Eigen::Vector3d own = caster.array().floor();
    for (int k = 0; k < steps; ++k) {
      const Eigen::Vector3d at = (caster + (from + (k + 0.5) * step) * ray).array().floor();
      if (std::abs(at.x()) > kReach || std::abs(at.z()) > kReach) continue;
      const Effect& effect = effects[static_cast<std::size_t>((static_cast<int>(at.x()) + kReach) * kSide +
                                                              static_cast<int>(at.z()) + kReach)];
      lost += step * cosine * cosine * (at == own ? effect.inside : effect.in_front);
    }
  }
  return side * side * lost / hits;
}

}  // namespace rayfield::density
