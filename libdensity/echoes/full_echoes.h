#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "libdensity/echoes/echo_columns.h"

namespace rayfield::density {

/// Mean cosine of the angle between rays and the normals of leaves that they meet, of leaves turned at random.
inline constexpr double kSphericalMeanCosine = 2.0 / 3;

/// One of a beam that fell wholly on a leaf. Cosines of the angle between the beam and the leaf's normal: from all
/// echoes around it, and from either half of them, so that errors of the two are independent; halves of several ways to
/// divide them.
struct FullEcho {
  static constexpr std::size_t kWays = 3;
  std::uint16_t intensity = 0;
  float spread_m = 0;  ///< rms of the echoes around it from their plane
  float cosine = 1;
  std::array<std::array<float, 2>, kWays> half_cosine{};
  float ray_up = 0;           ///< vertical part of the direction against the beam, a unit vector,
  float normal_up = 0;        ///< and of the normal that looks at the lidar
  float normal_variance = 0;  ///< of the normal, along either axis across it (rad²), from how the halves' differ
  bool operator==(const FullEcho&) const = default;
};

/// The full echoes among those of one place: an echo is full when all round it, just outside its beam, other beams from
/// about the same direction ended on one plane through it, and none inside ended elsewhere. Looks at every eighth echo,
/// then at those beside these, and so on, until it has found `enough`. In no order that depends on that of the echoes.
std::vector<FullEcho> find_full_echoes(const EchoColumns& columns,
                                       std::size_t enough = std::numeric_limits<std::size_t>::max());

/// Those whose surroundings are nearly as flat as the ranges' noise allows (1.4 of the spread that a tenth of them do
/// not reach), so that bundles of canes are left out.
std::vector<FullEcho> flattest_of(std::span<const FullEcho> echoes);

/// What full echoes tell.
struct FullEchoStrength {
  double intensity = 0;  ///< of an echo of leaves that take the whole beam, in the mean over the angles at which rays
                         ///< meet leaves
  double error = 0;      ///< its relative standard error
  double slope = 0;  ///< per unit of the cosine of the angle of incidence, relative to the median of the full echoes;
                     ///< of none the belief beforehand
  double slope_error = 0;       ///< its standard error
  double per_cosine = 0;        ///< the same, in units of intensity
  double angle_dependence = 0;  ///< 0 … 1: what that slope means of 1 − this·(1 − cosine)
  double scatter = 0;           ///< of the full echoes about the slope, standard deviation over their mean
  std::size_t count = 0;        ///< of full echoes that count
};

/// A belief about how an echo's intensity depends on the angle of incidence: change per unit of cosine over its median.
struct AngleDependence {
  double slope = 0.35;  ///< between no dependence and Lambert's law
  double error = 0.35;  ///< standard error
};

/// Of the flattest: their mean (of those brighter than two medians as if they were that), moved from their mean cosine
/// to ⅔, that of rays that meet leaves of all orientations (hits go with the cosine). A mean, since some of each full
/// echo is missing, and what scatters intensities, like speckle, moves a median then and no mean (docs/beams.md, "How
/// it is taken out"). The slope on the way: difference of the medians of the full echoes on either side of the median
/// of one half's cosine, over that of the means of the other half's (an instrument: errors of the angle do not make the
/// slope flatter), of all ways to divide, weighted with `prior` by their errors.
FullEchoStrength full_echo_strength(std::span<const FullEcho> echoes, const AngleDependence& prior);

}  // namespace rayfield::density
