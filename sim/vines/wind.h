#pragma once

#include <Eigen/Core>
#include <vector>

#include "rayfield/sim/site.h"
#include "sim/terrain/block_geometry.h"
#include "sim/terrain/triangle_mesh.h"

namespace rayfield::sim {

/// Where in the wind's cycle a moment of the drive lies, 0 … 1: the wind repeats itself every two minutes.
double wind_phase(double time_s);

/// Vertices of a row's leaves (four per leaf) at times spread evenly over the cycle, the last as the first. Leaves that
/// lie within one stretch of site.wind.coherence_m along the row move together; displacements of different stretches
/// and times are independent and normal, with site.wind.rms_m over the cycle along each horizontal axis.
std::vector<std::vector<Eigen::Vector3f>> blown_leaves(const Site& site, std::uint64_t seed, const BlockGeometry& block,
                                                       int row, const TriangleMesh& leaves);

}  // namespace rayfield::sim
