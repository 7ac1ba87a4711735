#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "rayfield/experiments/leaf_normals.h"
#include "rayfield/sim/random.h"

/// voxel: one cubic voxel from (0, 0, 0) to (w, w, w), with triangles for leaves.
namespace rayfield::experiments {

using Triangle = std::array<Eigen::Vector3d, 3>;

/// Area of the part of a triangle that lies in the voxel, m². Its corners are cut off plane by plane (Sutherland and
/// Hodgman 1974).
double area_inside(const Triangle& triangle, double voxel_m);

/// Where the line from `origin` along `direction` meets the triangle, in units of the direction's length; infinite
/// where it does not (Möller and Trumbore 1997).
double distance_to(const Triangle& triangle, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// Area of an equilateral triangle: √3/4·l². (The paper's text has √(3/4)·l², twice as much.)
double equilateral_area(double side_m);

/// Equilateral leaves around and in the voxel: a Poisson process of middles, of so many per volume that the voxel holds
/// `area_m2` in the mean, wide enough around it that every leaf which reaches into the voxel can be there.
struct LeafPopulation {
  double voxel_m = 0.1;
  double side_m = 0.025;
  double area_m2 = 0.01;
  LeafNormals normals;
};
/// `leaves` is overwritten; it is kept for its memory. Only leaves that may reach into the voxel are left in it.
void grow_leaves(const LeafPopulation& population, sim::CounterRandom& random, std::vector<Triangle>& leaves);

Eigen::Vector3d draw_normal(const LeafNormals& normals, sim::CounterRandom& random);

}  // namespace rayfield::experiments
