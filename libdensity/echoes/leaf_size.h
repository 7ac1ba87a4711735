#pragma once

#include <cstdint>
#include <span>

#include "libdensity/echoes/leaf_size_pairs.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// Area of a typical leaf, m².
struct LeafSize {
  double area_m2 = kDefaultAreaM2;
  bool measured = false;  ///< false: too few pairs, the default
  std::uint64_t pairs = 0;

  /// Between small (35 cm²) and large (100 cm²) vine leaves; used where the data cannot tell.
  static constexpr double kDefaultAreaM2 = 0.006;
  /// What looks larger (trunks and posts through wide beams) counts as this; EstimatorOptions takes no more either.
  static constexpr double kLargestM2 = 0.05;
};

/// Standard deviation of one range, m: from how far the ends of close rays (from 1 cm apart on, up to 4, until there
/// are enough) lie from the hit beside them, by the share of those up to 10 cm away that are within 2 cm, other leaves
/// taken out as many as there are per depth at 10 to 20 cm. 0 with fewer than 1000 such pairs. In simulations within 1
/// mm from 1 to 2 cm among leaves, and 1 to 4 mm too large where canes and edges lie close behind each other or beams
/// are wide.
double range_noise_of(const LeafSizePairs& pairs);

/// The usual windows where the noise of ranges is up to 1.75 cm, as range_noise_of() tells it; above it windows of four
/// of its standard deviations, up to 10 cm.
PairWindows windows_of(const LeafSizePairs& pairs);

/// The side of square leaves, isotropically orientated, for which the expected share of pairs on one leaf equals
/// the observed one, squared. Other hits near the same depth are taken out with the hazards in front and behind.
/// Within 15 % for leaves of 35–100 cm² in simulated hedges; canes and wires count as what they look like.
LeafSize estimate_leaf_size(const PairCounts& counts, const PairWindows& windows);
inline LeafSize estimate_leaf_size(const LeafSizePairs& pairs) {
  const PairWindows windows = windows_of(pairs);
  return estimate_leaf_size(counts_of(pairs, windows.window_m), windows);
}

/// Probability that a parallel ray at lateral distance r from a ray that hits a square leaf hits the same leaf,
/// with a difference of range below the window.
double same_leaf_probability(double distance_m, double side_m, const PairWindows& windows);

/// How large leaves turned like that look to estimate_leaf_size(), which takes them for turned at random: the side that
/// it finds over theirs, where hits of rays of these sines of elevation are as frequent as `hits` says. Leaves that lie
/// flat look small to level rays: narrow, and their far ends too far away for the windows. Of pairs 2.5 cm apart on
/// leaves of 8 cm: 0.7 for an ellipsoid of 2.5, 5 % more or less with the distance. 1 for spherical leaves.
double apparent_side(const LeafAngles& angles, std::span<const double> sines, std::span<const double> hits);

/// What a leaf that is hit in a voxel takes of the potential path of other rays through that voxel, as a share of
/// it.
struct LeafShadow {
  double in_front = 0;  ///< by its parts that lie outside the voxel, on the way to it
  double inside = 0;    ///< by its parts inside, behind which nothing is seen
};
/// Square leaves, isotropic normals, any place of the hit; the other rays come from where the ray came from that hit
/// (a drive sees a voxel from few directions), so that the mean of c² and not c̄² counts, c the cosine to the normal: a
/// third more than for rays of all directions. By quadrature with fixed random numbers; 0 in the limit of small
/// leaves.
LeafShadow leaf_shadow(double area_m2, double voxel_m);

}  // namespace rayfield::density
