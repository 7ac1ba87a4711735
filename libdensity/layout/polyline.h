#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace rayfield::density {

double polyline_length(std::span<const Eigen::Vector2d> line);

/// Point and unit tangent at a chainage; beyond the ends the line goes on straight.
struct LinePoint {
  Eigen::Vector2d position, direction;
};
LinePoint point_at(std::span<const Eigen::Vector2d> line, double chainage_m);

/// Where a point projects onto a line.
struct LineProjection {
  double chainage_m = 0;
  double across_m = 0;  ///< positive to the left of the line's direction
  bool inside = false;  ///< false: the point lies before the first or after the last vertex
};
/// The nearest projection; the first and last segments are prolonged without end. `line` has at least two vertices.
LineProjection project_onto_line(std::span<const Eigen::Vector2d> line, const Eigen::Vector2d& p);

/// The same line with vertices `step_m` apart (the last step is shorter or longer by at most half a step).
std::vector<Eigen::Vector2d> resampled(std::span<const Eigen::Vector2d> line, double step_m);

/// The part between two chainages, both ends exact; chainages outside prolong the line.
std::vector<Eigen::Vector2d> sub_line(std::span<const Eigen::Vector2d> line, double start_m, double end_m);

/// Smooth values through noisy ones at equal spacing: minimises Σ w (x−y)² + stiffness·Σ (third difference)²,
/// re-weighted (Tukey, `scale`) so that single bad values do not pull. Weights may be zero. `scale` ≤ 0: no
/// re-weighting.
std::vector<double> smooth_values(std::span<const double> values, std::span<const double> weights, double stiffness,
                                  double scale);

}  // namespace rayfield::density
