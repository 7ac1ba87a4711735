#pragma once
/// echoes: what the echoes of a scan tell of the leaves and of the lidar's beam (docs/beams.md).

#include <optional>

#include "libdensity/echoes/echo_statistics.h"
#include "libdensity/echoes/leaf_angle.h"
#include "rayfield/core/lidar_beam.h"

namespace rayfield::density {

/// Where the size of the leaves is from: too few pairs of neighbouring beams, so that it is the default; pairs;
/// options.
enum class LeafSizeFrom { nothing, pairs, options };

/// What the echoes of a scan mean where its beam is not thin (docs/beams.md, "How it is taken out").
struct EchoModel {
  LidarBeam beam;
  double range_resolution_m = 0;
  double full_echo = 0;        ///< mean intensity of an echo of leaves that take the whole beam
  double full_echo_error = 0;  ///< relative standard error
  double detection_share = 0;  ///< weakest echo, in full ones
  double leaf_size_m2 = 0;     ///< of one leaf
  LeafSizeFrom leaf_size_from = LeafSizeFrom::nothing;
  double echo_variation = 0;  ///< variance of the echoes' intensities over the square of their mean
  double mean_width_m = 0;    ///< of the beams where they met leaves
  double leaves_per_resolution =
      0;  ///< optical path of a range resolution among leaves: how many make an echo together
  /// Of what leaves take of the beams: the share in pieces below the detection share, which are in no echo.
  double lost_share = 0;
  double unreturned_share = 0;  ///< and the share of it whose beams return nothing (unreturned_per_lost())
  /// How the full echo goes with the mean cosine of the angle between rays and leaves: change per unit.
  double full_echo_per_cosine = 0;
  double angle_slope = 0;    ///< the same of full echoes alone, relative: FullEchoStrength::slope
  double lacking_share = 0;  ///< of full echoes, which the full echo has been made up for
  /// By which the full echo is from the mean echo, and not from full ones.
  double mean_echo_weight = 0;
  /// Whether the scan lacks the downward rays that came back from nowhere (VoxelOptions::sure_return_m is not 0).
  bool lacks_downward_misses = false;
  /// Whether the range resolution is what is likely, and neither told nor measured, and its standard error.
  bool resolution_assumed = false;
  double range_resolution_error_m = 0;
  /// How bright wood amid the leaves is beside them (wood_brightness()), and half its surface, m² per m² of the
  /// canopy's side: 0 where wood counts for what leaves of its echoes would.
  double wood_brightness = 1, wood_per_side = 0;
  double wood_error = 0;  ///< standard error of the logarithm of areas by that (wood_error())
  /// What the normals of full echoes tell of how leaves are turned (fit_leaf_normals()).
  std::optional<LnRatio> leaf_normals;
  /// Of a scan of bare vines: WoodEchoes::returned_share, in place of all that is said of leaves.
  std::optional<double> wood_returned;
};

/// The model of leaves that are not turned at random: its full echo is that of rays that meet them so, its leaves are
/// as much larger as they look too small, where they were measured, so that full echoes lack less and the mean echo
/// holds more of one.
EchoModel with_aspect(EchoModel model, const LeafAspect& aspect);

/// The model that takes wood for leaves. Where scans of one block are subtracted from each other, wood that is seen
/// alike in both cancels.
EchoModel with_wood_as_leaves(EchoModel model);

/// Whether the vines bear leaves, as far as it is known before anything is seen of them: as declared, or by the month.
enum class Foliage { unknown, none, unlikely, likely };

/// What is known beforehand.
struct EchoKnowledge {
  LidarBeam beam;
  double range_resolution_m = 0.15;
  double full_echo = 0;      ///< 0: from the statistics
  double leaf_size_m2 = -1;  ///< negative: from the statistics
  double wood_per_side = 0;  ///< half the surface of canes, cordons and wires, m² per m² of the canopy's side
  Foliage foliage = Foliage::unknown;
};

/// Whether the lidar sends one beam after the other, so that the previous one is the one beside: of a scan, or a tile.
bool sends_one_beam(const EchoStatistics& statistics);

/// Nothing where the echoes do not tell: too few (5000 of leaves, 1000 of bare vines), or all of one intensity.
///
/// Of bare vines, and where fewer than 8 − 9·min(0.45, e) echoes are to one of a beam that falls wholly on a post or
/// trunk, e the ends per metre of rays that pass a hit and end 5 to 15 cm behind it (four thirds of that many where
/// leaves are unlikely, half where they are likely; six, where too few pass hits to tell e), or the full echo comes out
/// below 0.55 of that of posts and trunks, so that canes make it, unless leaves are likely: wood_echoes(), with
/// EchoModel::wood_returned, or nothing where too few beams fell on posts and trunks. Else:
///
/// Full echo: two estimates weighted by their errors. One is of beams that fell wholly on a leaf
/// (full_echo_strength()), where there are ten of them, over what they lack: 1.8·(D/s)^2.5·exp(−b/0.15 m − t/0.3), D
/// the mean width of the beams, s the side of a leaf, b the range resolution, t the detection share, at most 0.3. The
/// other is the mean echo times exp(0.47 + (0.04 + 0.71·D/s)·exp(−0.75·n) − 0.05·slope − 0.54·I₂/mean −
/// 0.43·ln(I₂₀/mean) − 1.02·ln(I₄₀/mean) − 1.24·ln(I₉₀/mean)), the exponent kept between 0 and 0.7, n how many leaves
/// stand in a range resolution (b times ends_per_metre_behind()), the slope FullEchoStrength::slope, I_p the strength
/// that p % of the echoes do not reach, and at least 0.9 of what the bright ones say, which pieces of canes do not
/// change: I₉₈·exp(−0.112 + 4.235·ln(I₉₀/I₉₈) − 1.748·ln(I₈₀/I₉₈) − 0.16·slope + 0.235·D/s); 4 % off, and 0.7 over the
/// echoes for each of a beam that falls wholly on a post. Detection share: the weakest over 1.03 full echoes. What
/// beams without an echo have met: unreturned_per_lost(), with the angle dependence and scatter of the full echoes.
///
/// Leaves: estimate_leaf_size() of pairs. Their side looks larger the wider the beams are, and smaller the coarser the
/// range resolution is, since echoes of one leaf lie apart where other leaves behind it are in some of them: by
/// exp(0.27 + 1.02·D/60 mm − 3.03·b), b in m, up to 0.4. Lidars with several beams: pairs of at least half a full echo
/// up to 6 cm apart, in windows of ± 8 cm, and 1.12. Fitted, to simulated scans (docs/beams-fits.md): all numbers here.
std::optional<EchoModel> estimate_echo_model(const EchoStatistics& statistics, const EchoKnowledge& known);

}  // namespace rayfield::density
