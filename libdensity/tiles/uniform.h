#pragma once

#include <cstdint>
#include <random>

namespace rayfield::density {

/// Uniform numbers that are the same on every platform (std::uniform_real_distribution need not be).
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : engine_(seed) {}
  /// In (0, 1).
  double operator()() { return (static_cast<double>(engine_() >> 11) + 0.5) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * (*this)(); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace rayfield::density
