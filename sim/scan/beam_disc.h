#pragma once

#include <Eigen/Core>
#include <vector>

#include "rayfield/sim/site.h"

namespace rayfield::sim {

/// Where the sub-rays of a beam pass its cross-section, in units of the beam's radius. Each carries the same share of
/// the energy: they lie evenly over the unit disc for a uniform beam and closer to the axis for a Gaussian one.
std::vector<Eigen::Vector2d> beam_disc(EnergyProfile profile, int sub_rays);

}  // namespace rayfield::sim
