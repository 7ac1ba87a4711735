#pragma once

#include <array>
#include <cstdint>

namespace rayfield::density {

/// What neighbouring beams say about the size of the leaves (docs/density.md, "How large is a leaf").
///
/// For every hit in a voxel, the next ray of the scan (beams of a lidar follow one another at a degree or so) passes at
/// some distance r from it. Seen from there, with Δ = range of the next ray − distance at which it passes the hit, the
/// next ray ends in front (−2w ≤ Δ < −w), at the same depth (|Δ| < w), behind (w ≤ Δ < 2w) or beyond. Rays that ended
/// before −2w never came near and are not counted. Counts by r, in steps of kStep.
struct LeafSizePairs {
  static constexpr int kBins = 16;
  static constexpr double kStepM = 0.005;
  static constexpr double kWindowM = 0.05;  ///< w: leaf tilt at r ≤ 4 cm and range noise ≤ 1.5 cm stay mostly inside
  std::array<std::uint64_t, kBins> near{}, front{}, same{}, behind{};

  LeafSizePairs& operator+=(const LeafSizePairs& other);
  bool operator==(const LeafSizePairs&) const = default;
  /// One pair: the next ray passes at `distance_m`, and ends `delta_m` beyond it (`hit`), or goes on at least that far.
  void add(double distance_m, double delta_m, bool hit) { add(distance_m, delta_m, hit, *this); }
  /// The same, with the ray counted here and where it ends in `ends`.
  void add(double distance_m, double delta_m, bool hit, LeafSizePairs& ends);
};

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

/// The side of square leaves, isotropically orientated, for which the expected share of pairs on one leaf equals
/// the observed one, squared. Other hits near the same depth are taken out with the hazards in front and behind.
/// `range_noise_m`: standard deviation of one range (matters little: it is small against the window).
/// Within 15 % for leaves of 35–100 cm² in simulated hedges; canes and wires count as what they look like.
LeafSize estimate_leaf_size(const LeafSizePairs& pairs, double range_noise_m = 0.012);

/// Pairs up to 4 cm apart. Of lidars with one beam most echoes have one, of lidars with several at a time few.
std::uint64_t close_pairs(const LeafSizePairs& pairs);

/// Probability that a parallel ray at lateral distance r from a ray that hits a square leaf hits the same leaf,
/// with a difference of range below the window of LeafSizePairs.
double same_leaf_probability(double distance_m, double side_m, double range_noise_m);

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
