#pragma once

namespace rayfield::density {

/// How differently bright leaves are to the lidar.
struct LeafBrightness {
  /// What a leaf throws back goes with 1 − angle_dependence·(1 − cosine of the angle of incidence): 0 not at all, 1 as
  /// Lambert's law says.
  double angle_dependence = 0;
  double scatter = 0;  ///< from leaf to leaf beside that, standard deviation over the mean
};

/// What beams that return nothing have met of leaves, over the strength that is lost with them as the echoes just above
/// the detection share tell it (EchoModel::lost_share; both over all that leaves take of the beams). Beams end on what
/// they meet however dark it is: of differently bright leaves it is the dark ones, and those seen edge-on, that do not
/// return, so that more is hidden behind beams without an echo than strength is missing.
///
/// Single leaves, turned at random (hits go with the cosine): of the share 1 − π·x + π·x²/2 of what they take of the
/// beams, x the beam's width over the side of a leaf, the beam falls wholly on the leaf; of the others leaves take any
/// part alike (docs/beams.md, "How it is taken out"). `detection_share`: in full echoes, over 0.
double unreturned_per_lost(const LeafBrightness& leaves, double detection_share, double widths_of_leaf);

/// Pieces below the detection share t, as a share of those that a number of echoes per unit of strength would make if
/// it went on as it is just above t: f·t²/2. Between t and t + kBandAboveWeakest.
inline constexpr double kPiecesBelow = 1.2, kBandAboveWeakest = 0.1;

}  // namespace rayfield::density
