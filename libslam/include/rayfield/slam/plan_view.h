#pragma once

#include <cstdint>

#include "rayfield/core/grid2.h"
#include "rayfield/core/ray.h"
#include "rayfield/slam/trajectory.h"

namespace rayfield::slam {

/// An empty plan view of a drive: a grid of hits per cell that covers the trajectory and `reach_m` around it. Cells are
/// larger than `cell_m` if there would be more than 4000 × 4000.
Grid2<std::uint32_t> plan_grid(const Trajectory& trajectory, double reach_m, double cell_m);
/// Counts the hits of `rays` in their cells; those outside the grid are left out.
void add_hits(Grid2<std::uint32_t>& grid, const RayBatch& rays);

}  // namespace rayfield::slam
