#pragma once

#include <array>
#include <cstddef>

namespace rayfield::density {

/// Of the share that leaves take of a wide beam, what comes back in its echo: sums of echoes' strengths per optical
/// path, over what thin rays would count; 1 for thin beams, less the wider they are. What leaves take in pieces below
/// the detection share makes no echo and is missing from the beam behind. Random leaves (tests/accuracy/echo_loss.py).
/// Beyond the table its ends hold.
class ReturnedShare {
 public:
  /// `detection_share`: 0 … 0.5. `resolution_path`: optical path of a range resolution around echoes, mean number of
  /// hits of thin rays in it: how many leaves add up to one echo.
  ReturnedShare(double detection_share, double resolution_path);

  /// `diameter_sides`: the beam's diameter over the side of a leaf, up to 1.3. `optical_path`: mean number of hits of
  /// thin rays on the way before.
  double operator()(double diameter_sides, double optical_path) const;

 private:
  static constexpr std::size_t kDiameters = 9, kDepths = 5;
  std::array<std::array<double, kDepths>, kDiameters> returned_{};
};

/// Mean strength of an echo of random leaves, in full ones, in canopy as dense as it is around echoes: leaves behind
/// one another within the range resolution make one echo.
double mean_echo_share(double diameter_sides, double detection_share);

}  // namespace rayfield::density
