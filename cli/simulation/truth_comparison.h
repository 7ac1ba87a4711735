#pragma once

#include <span>

#include "rayfield/core/products.h"
#include "rayfield/sim/truth.h"

namespace rayfield::cli {

/// Areas of one date of a simulated block against its truth, over the panels that were measured and identified.
struct TruthComparison {
  int panels = 0;  ///< compared
  double plant_area_m2 = 0, true_plant_area_m2 = 0, plant_rrmse = 0;
  double leaf_area_m2 = 0, true_leaf_area_m2 = 0;
  double leaf_rms_m2 = 0;  ///< root mean square error of a panel's leaf area
};

/// Panels are identified by place. The block lies where the positioning of its reference put it, so that the middles of
/// all panels are laid on each other first; `block` has all panels of the site.
TruthComparison compare_with_truth(const BlockProducts& block, const ScanResults& scan,
                                   std::span<const sim::Truth::Panel> truth);

}  // namespace rayfield::cli
