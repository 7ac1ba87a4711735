#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/density/survey.h"

namespace rayfield::density {

/// How the trajectory is cut into passes along lanes.
struct PassOptions {
  double spacing_m = 0.5;    ///< between the vertices of a pass, 0.1…2
  double min_length_m = 6;   ///< shorter pieces are turns or manoeuvres, 3…100
  double min_radius_m = 12;  ///< tighter bends are headland turns, 5…50; rows may curve down to about five times it
  double max_jump_m = 3;     ///< between successive path points: further = the track is cut, 0.5…20
  Result<void> validate() const;
};

/// A piece of the trajectory without turns: one pass along one lane (or along a headland).
struct Pass {
  std::vector<Eigen::Vector2d> line;  ///< smoothed, equally spaced vertices, in the direction of driving, m
  double start_time_s = 0, end_time_s = 0;
  double length_m() const;
};

/// Cuts the trajectory at turns, reversals, standstills and jumps. Empty when nothing is long enough.
std::vector<Pass> find_passes(std::span<const PathPoint> path, const PassOptions& options);

/// The straightest long piece of a trajectory.
struct StraightRun {
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< unit vector from tail to head
  double length_m = 0, width_m = 0;
  double score_m = 0;  ///< v = l²/w
};

/// Maximises v = l²/w over pieces of the passes (paper, appendix Row Segmentation): greedy, advancing whichever end of
/// the piece gains more, from several starts. The width is taken as at least 0.1 m. score 0 when there are no passes.
StraightRun longest_straight_run(std::span<const Pass> passes);

}  // namespace rayfield::density
