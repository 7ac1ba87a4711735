#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace rayfield::sim {

/// A quintic B-spline on equally spaced knots: four times continuously differentiable. Control points attract the
/// curve and do not lie on it; it stays in their convex hull. Parameters outside the range are held at its ends.
template <int D>
class UniformSpline {
 public:
  using Vector = Eigen::Matrix<double, D, 1>;
  static constexpr int kDegree = 5;

  struct Values {
    Vector value, first, second;  ///< the curve and its derivatives
  };

  UniformSpline() = default;
  /// Needs at least six control points; the parameter runs from `start` over (count − 5)·`step`.
  UniformSpline(double start, double step, std::vector<Vector> control)
      : start_(start), step_(step), control_(std::move(control)) {}

  double start() const { return start_; }
  double end() const { return start_ + step_ * (static_cast<double>(control_.size()) - kDegree); }

  Vector value(double t) const {
    const auto [first, u] = locate(t);
    const auto w = basis<kDegree>(u);
    Vector sum = w[0] * control_[first];
    for (std::size_t j = 1; j <= kDegree; ++j) sum += w[j] * control_[first + j];
    return sum;
  }

  Values evaluate(double t) const {
    const auto [first, u] = locate(t);
    const auto w = basis<kDegree>(u);
    const auto w4 = basis<kDegree - 1>(u);
    const auto w3 = basis<kDegree - 2>(u);
    Values out;
    out.value.setZero(), out.first.setZero(), out.second.setZero();
    for (std::size_t j = 0; j <= kDegree; ++j) {
      const Vector& c = control_[first + j];
      out.value += w[j] * c;
      out.first += (at(w4, j, 1) - at(w4, j, 0)) / step_ * c;
      out.second += (at(w3, j, 2) - 2 * at(w3, j, 1) + at(w3, j, 0)) / (step_ * step_) * c;
    }
    return out;
  }

 private:
  double start_ = 0, step_ = 1;
  std::vector<Vector> control_;

  struct Place {
    std::size_t first;
    double u;
  };
  Place locate(double t) const {
    const double last = static_cast<double>(control_.size()) - kDegree - 1;
    const double x = std::clamp((t - start_) / step_, 0.0, last + 1);
    const double cell = std::min(std::floor(x), last);
    return {static_cast<std::size_t>(cell), x - cell};
  }

  // The Degree + 1 basis functions that are not zero at u ∈ [0, 1), oldest first (Cox–de Boor on the integers).
  template <int Degree>
  static std::array<double, Degree + 1> basis(double u) {
    std::array<double, Degree + 1> w{};
    w[0] = 1;
    for (int d = 1; d <= Degree; ++d)
      for (int j = d; j >= 0; --j) {
        const double older = j > 0 ? w[static_cast<std::size_t>(j - 1)] : 0;
        const double same = j < d ? w[static_cast<std::size_t>(j)] : 0;
        w[static_cast<std::size_t>(j)] = ((u + d - j) * older + (j + 1 - u) * same) / d;
      }
    return w;
  }
  template <std::size_t N>
  static double at(const std::array<double, N>& w, std::size_t j, std::size_t back) {
    return j >= back && j - back < N ? w[j - back] : 0;
  }
};

}  // namespace rayfield::sim
