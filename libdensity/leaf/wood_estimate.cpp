#include "libdensity/leaf/wood_estimate.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "libdensity/integration/interval.h"
#include "libdensity/integration/row_shares.h"

namespace rayfield::density {
namespace {

constexpr int kSteps = 500;   // of each half of the quadrature
constexpr double kReach = 6;  // standard deviations of ln W that it covers

// A point of the quadrature, and the belief around it.
struct Believed {
  double wood, weight;
};

// Up to half of the plants in even steps of ln W. From there on W = P·(1 − v²) in even steps of v, in which
// dW/√(P − W) is even, so that nothing becomes infinite where the leaves do.
std::vector<Believed> belief(double plants, const WoodPriorOptions& options) {
  const double sigma = std::log(options.spread), middle = std::log(options.per_side);
  const auto density = [&](double wood) {  // of ln W
    const double z = (std::log(wood) - middle) / sigma;
    return std::exp(-0.5 * z * z);
  };
  std::vector<Believed> points;
  const double high = std::log(plants / 2), low = std::min(middle, high) - kReach * sigma;
  for (int i = 0; i < kSteps; ++i) {
    const double wood = std::exp(low + (i + 0.5) * (high - low) / kSteps);
    points.push_back({wood, density(wood) / std::sqrt(plants - wood) * (high - low) / kSteps});
  }
  const double widest = std::sqrt(0.5);
  for (int i = kSteps; i-- > 0;) {
    const double v = (i + 0.5) * widest / kSteps, wood = plants * (1 - v * v);
    points.push_back({wood, density(wood) / wood * 2 * std::sqrt(plants) * widest / kSteps});
  }
  return points;
}

// Side of the canopy of a panel, m².
double side_of(const PanelValue& value, const Panel& panel) {
  return (panel.end_m - panel.start_m) * (value.canopy_height_m - value.descriptors.canopy_base_m);
}

// What the barest scan shows of a panel, per area of its side.
std::optional<ThinPlants> seen_per_side(const PanelPlants& barest, const std::string& panel_uid, double side) {
  const auto seen = barest.find(panel_uid);
  if (seen == barest.end()) return std::nullopt;
  return ThinPlants{seen->second.area_m2 / side, seen->second.high_m2 / side};
}

// Of the area without masked wood. Nothing: the panel has no value.
std::optional<ThinWood> wood_of_panel(const PanelValue& value, const Panel& panel, const PanelPlants& barest,
                                      const WoodPriorOptions& options) {
  if (!std::isfinite(value.leaf_area_m2)) return std::nullopt;
  const double side = side_of(value, panel);
  if (!(value.leaf_area_m2 > 0) || !(side > 0)) return ThinWood{};
  const ThinWood wood =
      believe_wood(value.leaf_area_m2 / side, seen_per_side(barest, panel.identity.uid, side), options);
  return ThinWood{side * wood.mean, side * wood.most};
}

void set_leaf_area(PanelValue& value, const ThinWood& wood) {
  const double plants = value.leaf_area_m2;
  if (!(plants > 0)) return;
  const Reach reach{plants - value.ci_low_m2, value.ci_high_m2 - plants};
  const double left = 1 - wood.mean / plants;
  value.leaf_area_m2 = plants - wood.mean;
  value.leaf_area_per_m *= left, value.lai *= left, value.se_leaf_area_m2 *= left;
  value.ci_low_m2 = std::max(0.0, value.leaf_area_m2 - std::hypot(wood.most - wood.mean, reach.below));
  value.ci_high_m2 = value.leaf_area_m2 + std::hypot(wood.mean, reach.above);
}

// What of the plants of each panel is wood, and of the row's where a panel does not tell.
std::vector<double> wood_shares(std::span<const PanelValue> values, std::span<const std::optional<ThinWood>> woods) {
  double plants = 0, wood = 0;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (woods[k]) plants += values[k].leaf_area_m2, wood += woods[k]->mean;
  const double of_row = plants > 0 ? wood / plants : 0;
  std::vector<double> shares;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const bool tells = woods[k] && values[k].leaf_area_m2 > 0;
    shares.push_back(tells ? woods[k]->mean / values[k].leaf_area_m2 : of_row);
  }
  return shares;
}

}  // namespace

ThinWood believe_wood(double plant_per_side, const std::optional<ThinPlants>& barest, const WoodPriorOptions& options) {
  const double least = barest ? std::min(plant_per_side, barest->area_m2) : plant_per_side;
  const double most = barest ? std::min(plant_per_side, barest->high_m2) : plant_per_side;
  if (!(plant_per_side > 0)) return {};
  if (!(least > 0)) return {0, std::max(0.0, most)};
  const std::vector<Believed> points = belief(least, options);
  double sum = 0, moment = 0;
  for (const Believed& point : points) sum += point.weight, moment += point.weight * point.wood;
  if (!(sum > 0)) return {least, most};  // far less than vines have: all of it can be wood
  const double thickest = options.per_side * std::pow(options.spread, kNormal95);
  return {moment / sum, std::max(moment / sum, std::min(most, thickest))};
}

RowDensity take_out_wood(RowDensity plant, std::span<const Panel> panels, const PanelPlants& barest,
                         const WoodPriorOptions& options, std::span<PanelValue> values) {
  std::vector<std::optional<ThinWood>> woods;
  for (std::size_t k = 0; k < panels.size(); ++k) woods.push_back(wood_of_panel(values[k], panels[k], barest, options));
  const std::vector<double> shares = wood_shares(values, woods);
  const std::vector<RowSpan> spans = panel_spans(panels);
  for (int a = 0; a < plant.n_along; ++a) {
    double wood = 0;
    for (std::size_t k = 0; k < spans.size(); ++k) wood += share_between(plant, a, spans[k]) * shares[k];
    const auto left = static_cast<float>(1 - wood);
    for (int c = 0; c < plant.n_across; ++c)
      for (int u = 0; u < plant.n_up; ++u) {
        const std::size_t voxel = plant.index(a, c, u);
        plant.density[voxel] *= left, plant.variance[voxel] *= left * left;
      }
  }
  plant.wood_area.clear();
  for (std::size_t k = 0; k < panels.size(); ++k)
    if (woods[k]) set_leaf_area(values[k], *woods[k]);
  return plant;
}

}  // namespace rayfield::density
