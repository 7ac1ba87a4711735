#pragma once

#include <optional>

#include "libdensity/echoes/echo_statistics.h"

namespace rayfield::density {

/// What the echoes of bare vines mean: canes, cordons and wires, most of them thinner than the beam.
struct WoodEchoes {
  double full_echo = 0;  ///< mean intensity of an echo of thin wood that takes the whole beam
  /// Share of the strength that thin wood throws back that is in echoes; the rest is in pieces too weak for one.
  double returned_share = 1;
  /// Standard error of the logarithm of the plant area by it: 0.15, and 0.3 of what the returned share makes up for
  /// (its −ln). Twice what the 46 simulated scans have whose wood is of one thickness (docs/beams.md, "How far it can
  /// be trusted").
  double error = 0.15;
};

/// A cane across the middle of the beam takes 4·d/(π·D) of it (d its diameter, D the beam's), and less beside. All of
/// that is in echoes where it is large beside the detection share, and nothing where it is not; how large it is shows
/// in x, the mean strength of the echoes over `weakest`, the intensity where they begin. Vines have thick wood, too,
/// which is in the mean when canes are in no echo: exp(−3.3/x³), at least ¼, fitted to 32 simulated scans of bare vines
/// (docs/beams-fits.md, "Bare vines").
///
/// Thin wood is as bright as the trunks, which are narrow for a beam to fall wholly on: what 95 % of the echoes on them
/// do not reach, over what 95 % of those on posts do not, times the mean echo of the beams that fall wholly on posts
/// (0.4 to 2.5 times it). Where trunks or posts have fewer than 100 echoes, or posts fewer than 200 of such beams, it
/// is the mean of those that fall wholly on either. Nothing where fewer than 200 beams fell wholly on posts and trunks.
std::optional<WoodEchoes> wood_echoes(const EchoStatistics& statistics, double mean, double weakest);

/// How bright wood amid the leaves is beside them.
struct WoodBrightness {
  double value = 1;  ///< 0.4 to 1.6
  double error = 0;  ///< standard error, where trunks do not tell it well
};

/// Mean intensity of an echo of thin wood that takes the whole beam, as above, over that of leaves, `full_echo`. Where
/// posts are few, as in orchards, it is 1.10 times the mean echo of the beams that fall wholly on trunks, of which
/// part goes past (83 simulated scans: 0.96 to 1.31, 0.06 about the mean), if there are 200. Where trunks do not tell
/// it, either, wood is taken to be as bright as leaves, 0.3 off.
WoodBrightness wood_brightness(const EchoStatistics& statistics, double full_echo);

/// What areas are off where wood is not as bright as leaves, as a standard error of their logarithm: its part of the
/// echoes times what is not known of its brightness and 0.6 of what that differs from that of leaves, since how much of
/// it stands amid them is believed and not seen. Its part is 2.5 over the number of echoes for each of a beam that
/// falls wholly on a post or trunk (bare vines have 0.1 to 6.4, full leaf 20 and more), and 0.15 where fewer than 200
/// do.
double wood_error(const EchoStatistics& statistics, double full_echo);

}  // namespace rayfield::density
