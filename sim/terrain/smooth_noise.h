#pragma once

#include <cstdint>

#include "rayfield/sim/random.h"

namespace rayfield::sim {

/// Smooth random functions with zero mean and unit variance: white noise on the integers, blended by cubic B-splines
/// (twice continuously differentiable). One unit of x is the distance over which values become independent (about 2).
double smooth_noise(std::uint64_t seed, Stream stream, std::uint64_t channel, double x);
double smooth_noise(std::uint64_t seed, Stream stream, std::uint64_t channel, double x, double y);

}  // namespace rayfield::sim
