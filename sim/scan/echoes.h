#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "rayfield/sim/site.h"

namespace rayfield::sim {

/// What one sub-ray of a beam met.
struct SubEcho {
  double range_m;
  double energy;    ///< share of the beam's energy times reflectance, relative to a leaf that takes the whole beam;
                    ///< with Detection::returned_energy also the angle's part, relative to the mean leaf's
  double strength;  ///< the same for intensity, on a scale to 255
};

/// What the lidar makes of surfaces that lie within its range resolution.
struct Echo {
  double range_m = 0;  ///< mean over the surfaces, weighted with their energy
  double energy = 0, strength = 0;
};

/// Energy that makes an echo at a range: detection_share × (range / 5 m)^detection_range_exponent.
double detectable_energy(const SiteLidar& lidar, double range_m);

/// The return of a beam, and of lidars that report several echoes those behind it. Sub-rays are looked at in the order
/// of their ranges: a stretch of range_resolution_m from one of them on makes an echo if it holds the detectable
/// energy; the next echo begins behind that stretch. `lost` is asked for each echo whether it gets lost. `dither`
/// (uniform within ± half of a sub-ray's energy) is added to each stretch's energy before it is compared, so that a
/// finite number of sub-rays does not round the threshold. Sorts `hits`, which hold what was met only. `behind`: gets
/// what follows the return, SiteLidar::echoes − 1 at most, each more than range_resolution_m behind the one before.
std::optional<Echo> beam_return(const SiteLidar& lidar, std::span<SubEcho> hits, double dither,
                                const std::function<bool(const Echo&)>& lost, std::vector<Echo>* behind = nullptr);

}  // namespace rayfield::sim
