#pragma once

#include <optional>
#include <span>

#include "libdensity/estimate/row_density.h"
#include "libdensity/layout/row_layout.h"
#include "libdensity/leaf/scan_totals.h"
#include "rayfield/core/products.h"
#include "rayfield/density/options.h"

/// Wood where no dormant scan shows it. Posts and trunks are found by their shape and masked when rays are counted;
/// cordons, canes, branches and wires are too thin for that in leaf (docs/density.md, "Without a dormant scan").
namespace rayfield::density {

/// m² per m² of the canopy's side (length of row times height of the canopy).
struct ThinWood {
  double mean = 0;  ///< expected
  double most = 0;  ///< 97.5 % of vineyards and orchards have less, or all that is seen
};

/// What is believed of the wood W after a canopy of P = `plant_per_side` was seen, of which W + leaves = P:
///   p(W) ~ exp(−½·(ln(W/per_side)/ln(spread))²)/W · 1/√(B − W),  0 < W < B.
/// The first factor is what is known of vines and orchards in general (WoodPriorOptions), log-normal. The second is
/// Jeffreys' prior of a density of leaves, which come singly and at random: nothing is known of their amount, bare
/// vines and budburst included. B is P, or what the barest scan of the season shows where that is less: there is no
/// more wood than that, and its leaves may be few. By quadrature. The most is what is known in general, P, or the upper
/// end of what the barest scan shows: where P is no more than it, there may be no leaves at all.
/// `barest`: per area of side as `plant_per_side`.
ThinWood believe_wood(double plant_per_side, const std::optional<ThinPlants>& barest, const WoodPriorOptions& options);

/// Takes the expected wood out of the plants of a row, in each panel by its share of the panel's plants, and writes
/// what is left as leaf area into `values`, which hold what the scan's own rays say of `panels`. With A the panel's
/// area without masked wood, h and h⁺ how far its interval reaches below and above it, W the expected wood and W⁺ the
/// most, the interval is from A − W − √((W⁺ − W)² + h²) to A − W + √(W² + h⁺²), cut at 0:
/// there may be next to no wood. Panels without a value keep none; their densities lose the row's mean share. The
/// result has no masked wood. `barest`: of the panels in the barest scan of the season, as far as it shows them.
RowDensity take_out_wood(RowDensity plant, std::span<const Panel> panels, const PanelPlants& barest,
                         const WoodPriorOptions& options, std::span<PanelValue> values);

}  // namespace rayfield::density
