#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace rayfield::density {

/// What became of beams that go down to ground which is seen all around: of beams through a row, and of open ones
/// beside rows. Open ground answers, so that a beam which a row stands in the way of, and of which nothing comes back,
/// has been used up in part by pieces of leaves and wood too small for an echo (docs/beams.md, "How it is taken out").
/// Integers: any split of the beams gives the same sums.
class SilentBeams {
 public:
  enum class Outcome { ground, nothing, row };  ///< came back from the ground, from nowhere, or from what stands on it

  /// A beam by the cosine of its angle to the ground's normal, as that tells how strongly the ground answers.
  /// `intensity`: of its echo.
  void add(double cosine, bool through_row, Outcome outcome, int intensity);
  SilentBeams& operator+=(const SilentBeams& other);
  bool operator==(const SilentBeams&) const = default;

  /// Of what beams through rows send, the share that is used up without an echo. Silent beams are those from nowhere,
  /// less what open ground does not answer at the same angles. What is left of one would make ground answer with less
  /// than `weakest`, the intensity where echoes begin: of it 1 − ¾·weakest over the mean intensity of open ground is
  /// used up (all but what makes no echo, of which three quarters are left). Nothing where too few were seen: 2000
  /// through rows, at angles at which open ground answers at least seven of ten.
  std::optional<double> used_up(double weakest) const;

 private:
  static constexpr int kCosines = 50;
  struct Count {
    std::int64_t ground = 0, nothing = 0, row = 0, ground_intensity = 0;
    bool operator==(const Count&) const = default;
  };
  std::array<Count, kCosines> open_{}, through_{};
};

}  // namespace rayfield::density
