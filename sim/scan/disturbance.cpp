#include "sim/scan/disturbance.h"

#include <algorithm>
#include <cmath>

namespace rayfield::sim {
namespace {

constexpr double kDustDepth_m = 1.5;      // mean way of a beam into the dust around the vehicle
constexpr double kParticleStrength = 12;  // of 255

double exponential(double mean, CounterRandom& random) { return -mean * std::log(random.uniform()); }

}  // namespace

double chance_of_loss(const SiteDisturbance& disturbance, double energy, double detectable) {
  return disturbance.lost_echo_share * std::clamp(2 - energy / detectable, 0.0, 1.0);
}

// The same number of random numbers is drawn for every beam, so that one option does not change what another does.
std::optional<Echo> disturbed(const Site& site, const std::optional<Echo>& echo, CounterRandom& random) {
  const SiteDisturbance& options = site.disturbance;
  const SiteLidar& lidar = site.lidar;
  const bool in_dust = random.uniform() < options.dust_share;
  const double dust = lidar.min_range_m + exponential(kDustDepth_m, random);
  const double drop = exponential(1, random) / options.rain_per_m;  // infinitely far without rain
  const bool spurious = random.uniform() < options.spurious_share;
  const double anywhere = random.uniform(lidar.min_range_m, lidar.max_range_m);
  const double particle = std::min(in_dust ? dust : drop, drop);
  if (spurious) return Echo{anywhere, 0, kParticleStrength};
  if (particle < (echo ? echo->range_m : lidar.max_range_m)) return Echo{particle, 0, kParticleStrength};
  return echo;
}

}  // namespace rayfield::sim
