#pragma once

#include <Eigen/Core>
#include <vector>

#include "rayfield/core/grid2.h"

namespace rayfield {

/// A post or the trunk of a vine.
struct Upright {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of its axis at the ground, map m
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();    ///< unit vector along its row there; its sign is arbitrary
  double radius_m = 0;
  bool post = false;  ///< false: a trunk
};

/// The parts of a block that do not grow, as one scan shows them: scans of different dates are aligned by these. Map
/// coordinates (easting, northing, height), m.
struct BlockLandmarks {
  std::vector<Upright> uprights;
  std::vector<std::vector<Eigen::Vector2d>> rows;  ///< centrelines, at most a metre between vertices
  Grid2<float> ground;                ///< height in the middle of each cell beside the track; NaN = unknown
  std::vector<Eigen::Vector2d> path;  ///< the vehicle's track, at most a metre between points within a pass
  double row_spacing_m = 0;           ///< NaN for a single row
  double post_spacing_m = 0;          ///< NaN if unknown
};

}  // namespace rayfield
