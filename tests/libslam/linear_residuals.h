#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <random>

#include "libslam/solver/block_system.h"

namespace rayfield::slam::testing {

inline Eigen::VectorXd small_random(int n, unsigned seed, double scale) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> u(-scale, scale);
  Eigen::VectorXd x(n);
  for (double& v : x) v = u(generator);
  return x;
}

/// Dense Jacobian of a linearised residual.
template <int Rows>
Eigen::MatrixXd dense(const LinearResidual<Rows>& r, int blocks) {
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(Rows, 6 * blocks);
  for (int k = 0; k < r.blocks; ++k) j.middleCols(6 * r.block[k], 6) += r.jacobian[k];
  return j;
}

/// A vector function as Ceres calls it.
struct Functor {
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> f;
  int parameters;
  bool operator()(double const* const* x, double* out) const {
    const Eigen::VectorXd value = f(Eigen::Map<const Eigen::VectorXd>(x[0], parameters));
    std::copy(value.begin(), value.end(), out);
    return true;
  }
};

}  // namespace rayfield::slam::testing
