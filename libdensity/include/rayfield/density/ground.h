#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/grid2.h"
#include "rayfield/core/result.h"
#include "rayfield/density/ground_model.h"
#include "rayfield/density/survey.h"
#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Ground from the lifted lower convex hull (paper, appendix Ground Extraction), then refitted to the points near it.
struct GroundOptions {
  double curvature_per_m = 0.1;  ///< k of z + k(x²+y²), 0.01…1; larger follows sharper hollows, and more noise
  double halo_m = 8;           ///< neighbours used around a tile, 2…50; enough while relief within it is < k·halo²
  int min_support = 3;         ///< hits within support_m above a cell's candidate, 1…100; fewer = multipath
  double support_m = 0.10;     ///< 0.02…0.5
  double max_drop_m = 0.25;    ///< a candidate further below all its neighbours is multipath, 0.05…2
  double max_rise_m = 0.30;    ///< how far above the hull the ground may be (banks, noise), 0.05…1
  double fit_radius_m = 0.14;  ///< standard deviation of the local plane's weights, 0.05…1
  double max_gap_m = 2.0;      ///< nodes further than this from any supported cell are unknown, 0.25…20
  Result<void> validate() const;
};

/// A triangulated surface below points.
struct LowerHull {
  std::vector<std::array<int, 3>> triangles;  ///< indices of the input points, counter-clockwise in plan
};

/// Lower convex hull of the points lifted by k(x²+y²) about their centre (Qhull, option Qt). Points that are not finite
/// are left out. Errors: bad_input when the finite points do not span a volume after lifting (fewer than four,
/// collinear in plan, or all on one paraboloid); the reason says which.
Result<LowerHull> lower_hull(std::span<const Eigen::Vector3d> points, double curvature_per_m);

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

/// Stored form, kind "ground" version 1: column "height_m" of the tile's nodes.
tile::ArraySet ground_to_arrays(tile::TileIndex index, const GroundTile& ground);
/// The nodes and their tile. Errors: damaged.
Result<std::pair<tile::TileIndex, GroundTile>> ground_from_arrays(const tile::ArraySet& arrays);

}  // namespace rayfield::density
