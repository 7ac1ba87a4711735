#include "sim/scan/beam_disc.h"

#include <cmath>
#include <numbers>

namespace rayfield::sim {
namespace {

// Radius within which the share `energy` of the beam lies.
double radius_of_energy(EnergyProfile profile, double energy) {
  if (profile == EnergyProfile::uniform) return std::sqrt(energy);
  // Within radius x (in units of the 1/e² radius) lies 1 − exp(−2x²); the tail beyond 1.5 (1 %) is left out.
  constexpr double kEdge = 1.5;
  const double kept = 1 - std::exp(-2 * kEdge * kEdge);
  return std::sqrt(-0.5 * std::log(1 - kept * energy));
}

}  // namespace

// A sunflower (Vogel 1979, A better way to construct the sunflower head, Mathematical Biosciences 44): ring after ring
// of equal energy, turned by the golden angle.
std::vector<Eigen::Vector2d> beam_disc(EnergyProfile profile, int sub_rays) {
  constexpr double kGoldenAngle = std::numbers::pi * (3 - 2.23606797749978969641);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < sub_rays; ++i) {
    const double radius = radius_of_energy(profile, (i + 0.5) / sub_rays);
    points.emplace_back(radius * std::cos(kGoldenAngle * i), radius * std::sin(kGoldenAngle * i));
  }
  return points;
}

}  // namespace rayfield::sim
