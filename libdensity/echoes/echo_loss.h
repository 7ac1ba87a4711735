#pragma once

namespace rayfield::density {

/// Of the share that leaves take of a wide beam, what comes back in its echo: sums of echoes' shares per optical path,
/// over what thin rays would count; 1 for thin beams, less the wider they are. What leaves take in pieces below the
/// detection share makes no echo and is missing from the beam behind. Random leaves (tests/accuracy/echo_loss.py); what
/// is left out of the table is little: densities and range resolutions.
/// `diameter_sides`: the beam's diameter over the side of a leaf, up to 1.3. `detection_share`: 0 … 0.5.
/// `optical_path`: mean number of hits of thin rays on the way before.
double returned_share(double diameter_sides, double detection_share, double optical_path);

/// Mean share of the beam that an echo of random leaves holds, in canopy as dense as it is around echoes: leaves behind
/// one another within the range resolution make one echo.
double mean_echo_share(double diameter_sides, double detection_share);

}  // namespace rayfield::density
