#include "cli/simulation/truth_comparison.h"

#include <cmath>
#include <limits>
#include <map>
#include <string>

namespace rayfield::cli {
namespace {

Eigen::Vector2d middle_of(const PanelProduct& panel) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i + 1 < panel.outline.size(); ++i) sum += panel.outline[i];  // the ring is closed
  return sum / static_cast<double>(panel.outline.size() - 1);
}

}  // namespace

TruthComparison compare_with_truth(const BlockProducts& block, const ScanResults& scan,
                                   std::span<const sim::Truth::Panel> truth) {
  Eigen::Vector2d map_middle = Eigen::Vector2d::Zero(), true_middle = Eigen::Vector2d::Zero();
  std::map<std::string, Eigen::Vector2d> places;
  for (const PanelProduct& panel : block.panels) {
    places[panel.panel_uid] = middle_of(panel);
    map_middle += places[panel.panel_uid] / static_cast<double>(block.panels.size());
  }
  for (const sim::Truth::Panel& panel : truth)
    true_middle += 0.5 * (panel.from + panel.to) / static_cast<double>(truth.size());

  TruthComparison sums;
  double plant_squares = 0, leaf_squares = 0;
  for (const PanelValue& value : scan.panel_values) {
    if (!std::isfinite(value.plant_area_m2)) continue;
    const Eigen::Vector2d place = places[value.panel_uid] - map_middle + true_middle;
    const sim::Truth::Panel* panel = nullptr;
    double nearest = std::numeric_limits<double>::infinity();
    for (const sim::Truth::Panel& candidate : truth)
      if (const double distance = (0.5 * (candidate.from + candidate.to) - place).norm(); distance < nearest)
        nearest = distance, panel = &candidate;
    if (panel == nullptr || nearest > 0.35 * panel->length_m) continue;
    const double true_plant_m2 = panel->leaf_area_m2 + panel->wood_area_m2;
    ++sums.panels;
    sums.plant_area_m2 += value.plant_area_m2, sums.true_plant_area_m2 += true_plant_m2;
    sums.leaf_area_m2 += value.leaf_area_m2, sums.true_leaf_area_m2 += panel->leaf_area_m2;
    plant_squares += std::pow(value.plant_area_m2 - true_plant_m2, 2);
    leaf_squares += std::pow(value.leaf_area_m2 - panel->leaf_area_m2, 2);
  }
  if (sums.panels == 0) return sums;
  sums.plant_rrmse = std::sqrt(plant_squares / sums.panels) / (sums.true_plant_area_m2 / sums.panels);
  sums.leaf_rms_m2 = std::sqrt(leaf_squares / sums.panels);
  return sums;
}

}  // namespace rayfield::cli
