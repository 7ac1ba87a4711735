#include "libdensity/layout/polyline.h"
#include "libdensity/tiles/rounding.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rayfield::density {

double polyline_length(std::span<const Eigen::Vector2d> line) {
  double length = 0;
  for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  return length;
}

LinePoint point_at(std::span<const Eigen::Vector2d> line, double chainage_m) {
  double left = chainage_m;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector2d d = line[i] - line[i - 1];
    const double length = d.norm();
    if (left <= length || i + 1 == line.size()) {
      const Eigen::Vector2d u = length > 0 ? Eigen::Vector2d(d / length) : Eigen::Vector2d::UnitX();
      return {line[i - 1] + u * left, u};
    }
    left -= length;
  }
  return {line.empty() ? Eigen::Vector2d::Zero() : line.front(), Eigen::Vector2d::UnitX()};
}

LineProjection project_onto_line(std::span<const Eigen::Vector2d> line, const Eigen::Vector2d& p) {
  LineProjection best;
  double best_distance = std::numeric_limits<double>::infinity(), chainage = 0;
  const std::size_t n = line.size();
  for (std::size_t i = 1; i < n; ++i) {
    const Eigen::Vector2d d = line[i] - line[i - 1];
    const double length = d.norm();
    if (length <= 0) continue;
    const Eigen::Vector2d u = d / length, r = p - line[i - 1];
    double t = u.dot(r);
    const bool before = t < 0 && i == 1, after = t > length && i + 1 == n;
    const double clamped = std::clamp(t, before ? t : 0.0, after ? t : length);
    const double distance = (r - clamped * u).norm();
    if (distance < best_distance) {
      best_distance = distance;
      const double side = u.x() * r.y() - u.y() * r.x();
      best = {chainage + clamped, std::copysign(distance, side), !before && !after};
    }
    chainage += length;
  }
  return best;
}

std::vector<Eigen::Vector2d> resampled(std::span<const Eigen::Vector2d> line, double step_m) {
  const double length = polyline_length(line);
  const int n = std::max(1, round_int(length / step_m));
  std::vector<Eigen::Vector2d> out;
  out.reserve(static_cast<std::size_t>(n) + 1);
  for (int i = 0; i <= n; ++i) out.push_back(point_at(line, length * i / n).position);
  return out;
}

std::vector<Eigen::Vector2d> sub_line(std::span<const Eigen::Vector2d> line, double start_m, double end_m) {
  std::vector<Eigen::Vector2d> out{point_at(line, start_m).position};
  double chainage = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (i > 0) chainage += (line[i] - line[i - 1]).norm();
    if (chainage > start_m + 1e-6 && chainage < end_m - 1e-6) out.push_back(line[i]);
  }
  out.push_back(point_at(line, end_m).position);
  return out;
}

std::vector<double> smooth_values(std::span<const double> values, std::span<const double> weights, double stiffness,
                                  double scale) {
  const int n = static_cast<int>(values.size());
  std::vector<double> result(values.begin(), values.end());
  if (n < 4) return result;
  constexpr std::array<double, 4> kThird{-1, 3, -3, 1};
  std::vector<double> w(weights.begin(), weights.end());
  for (int iteration = 0; iteration < (scale > 0 ? 5 : 1); ++iteration) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right(n);
    for (int i = 0; i < n; ++i) {
      const std::size_t k = static_cast<std::size_t>(i);
      entries.emplace_back(i, i, w[k] + 1e-9);
      right(i) = w[k] * values[k];
    }
    for (int i = 0; i + 3 < n; ++i)
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) entries.emplace_back(i + a, i + b, stiffness * kThird[a] * kThird[b]);
    Eigen::SparseMatrix<double> normal(n, n);
    normal.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
    const Eigen::VectorXd x = solver.solve(right);
    for (int i = 0; i < n; ++i) {
      const std::size_t k = static_cast<std::size_t>(i);
      result[k] = x(i);
      if (scale > 0) {
        const double r = (values[k] - x(i)) / scale;
        w[k] = weights[k] * (std::abs(r) < 1 ? (1 - r * r) * (1 - r * r) : 0);
      }
    }
  }
  return result;
}

}  // namespace rayfield::density
