#pragma once
/// ground: one pass over a tile makes its survey; from the surveys follow the sensor's trajectory and the ground
/// (docs/ground.md).
#include <Eigen/Core>
#include <span>
#include <string>

#include "libdensity/ground/ground_model.h"
#include "libdensity/ground/survey.h"
#include "rayfield/core/grid2.h"
#include "rayfield/core/result.h"
#include "rayfield/density/layout_options.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Ground of one tile.
struct GroundTile {
  Grid2<float> nodes;  ///< heights at cell corners, see GroundModel; NaN = unknown
  int candidates = 0;  ///< supported cells in the tile and its halo
  int known_nodes = 0;
  double median_lift_m = 0;    ///< median of refitted ground minus hull: the bias of the bare hull; NaN if unknown
  std::string unknown_reason;  ///< why no node is known; empty if some are
};

/// `surveys`: the tile and whatever neighbours reach into its halo, in any order; all of the same scan and options.
/// A tile without usable points gives nodes that are all NaN and a reason.
/// Errors: usage (options, or surveys of different cell sizes).
Result<GroundTile> estimate_ground(tile::TileIndex index, std::span<const TileSurvey* const> surveys,
                                   const GroundOptions& options);

}  // namespace rayfield::density
