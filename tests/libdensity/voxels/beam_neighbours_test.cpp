#include "libdensity/voxels/beam_neighbours.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

namespace rayfield::density {
namespace {

Eigen::Vector3d direction(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * std::numbers::pi / 180, e = elevation_deg * std::numbers::pi / 180;
  return {std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)};
}

std::optional<std::size_t> number_of(const std::optional<BeamNeighbours::Beside>& beside) {
  return beside ? std::optional<std::size_t>(beside->number) : std::nullopt;
}

TEST(BeamNeighbours, OfOneBeamThePreviousRayIsBesideAndNoOtherOne) {
  BeamNeighbours rays;
  EXPECT_FALSE(rays.on_leaf_beside(direction(10, 0), 100.0).has_value());
  rays.add(0, direction(10, 0), 100.0, true);
  const auto beside = rays.on_leaf_beside(direction(10.7, 0), 100.00004);
  EXPECT_EQ(number_of(beside), 0u);
  EXPECT_TRUE(beside && beside->same_beam);
  rays.add(1, direction(10.7, 0), 100.00004, false);
  EXPECT_FALSE(rays.on_leaf_beside(direction(10.0, 0), 100.00008)) << "the one before it is nearer, but past";
  rays.add(2, direction(11.4, 0), 100.00008, true);
  EXPECT_FALSE(rays.on_leaf_beside(direction(30, 0), 100.00012).has_value());
}

TEST(BeamNeighbours, OfOneBeamInCoarseStepsItIsThePreviousRayToo) {
  BeamNeighbours rays;
  rays.add(0, direction(8.1, 0), 100.0, true);
  rays.add(1, direction(10, 0), 100.00004, true);
  const auto beside = rays.on_leaf_beside(direction(11.9, 0), 100.00008);
  EXPECT_EQ(number_of(beside), 1u);
  EXPECT_TRUE(beside && beside->same_beam);
}

// 32 beams a degree apart, all sent at once, that turn by 0.7° until the next time.
TEST(BeamNeighbours, OfSeveralBeamsCloseTogetherTheNearestRayIsBesideAndNotThePreviousOne) {
  BeamNeighbours rays;
  constexpr int kBeams = 32;
  for (int turn = 0; turn < 3; ++turn)
    for (int beam = 0; beam < kBeams; ++beam) {
      const std::size_t number = static_cast<std::size_t>(turn * kBeams + beam);
      const Eigen::Vector3d to = direction(0.7 * turn, beam - 15);
      const auto beside = rays.on_leaf_beside(to, 100 + 2e-4 * turn);
      if (turn > 0) EXPECT_EQ(number_of(beside), number - kBeams);
      EXPECT_FALSE(beside && beside->same_beam) << "from beam to beam no mirror turned";
      rays.add(number, to, 100 + 2e-4 * turn, true);
    }
}

TEST(BeamNeighbours, OfSeveralBeamsTheSameBeamsLastRayIsBesideWhateverItMet) {
  BeamNeighbours rays;
  constexpr int kBeams = 16;
  for (int turn = 0; turn < 3; ++turn)
    for (int beam = 0; beam < kBeams; ++beam) {
      const std::size_t number = static_cast<std::size_t>(turn * kBeams + beam);
      const Eigen::Vector3d to = direction(0.4 * turn, 2 * beam - 15);
      const auto beside = rays.on_leaf_beside(to, 100 + 1e-4 * turn);
      // Beam 3 meets a leaf on the first turn only, beam 5 on all.
      if (beam == 5 && turn > 0) EXPECT_EQ(number_of(beside), number - kBeams);
      if (beam == 3) EXPECT_EQ(beside.has_value(), turn == 1) << "two turns ago it did, but not the last time";
      rays.add(number, to, 100 + 1e-4 * turn, beam == 5 || (beam == 3 && turn == 0));
    }
  EXPECT_FALSE(rays.on_leaf_beside(direction(1.2, -5), 100.1).has_value()) << "long ago";
}

}  // namespace
}  // namespace rayfield::density
