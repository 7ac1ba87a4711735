#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "libdensity/rows/canopy_map.h"
#include "libdensity/rows/rows.h"

namespace rayfield::density {

/// A place beside a pass where a row's canopy seems to stand.
struct RidgeSeed {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< of the pass
  double offset_m = 0;                                   ///< from the pass, left positive
  double strength = 0;                                   ///< 0…1
};

/// A traced line of canopy.
struct Ridge {
  std::vector<Eigen::Vector2d> line;  ///< vertices 0.5 m apart, smoothed
  double offset_m = 0;                ///< distance of the pass that it was seeded from
  double strength = 0;                ///< mean canopy in the core, 0…1
  double cover = 0;                   ///< share of vertices with canopy
  double tall_share = 0;              ///< share of vertices under something tall
  double lane_share = 0;              ///< canopy in the denser of the two lanes beside, relative to the core
};

/// Canopy at a point, 0 (none) … 1 (eight or more hits in the cell).
double canopy_at(const CanopyMap& canopy, const Eigen::Vector2d& p);

/// Seeds on both sides of a pass, at most one per side and eight metres.
std::vector<RidgeSeed> find_seeds(const Pass& pass, const CanopyMap& canopy, const RowOptions& options);

/// Follows the canopy from a seed in both directions until a gap; nullopt if nothing of min_length_m comes of it.
std::optional<Ridge> trace_ridge(const RidgeSeed& seed, const CanopyMap& canopy, const RowOptions& options);

}  // namespace rayfield::density
