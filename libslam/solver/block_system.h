/// solver: residuals, their Jacobians, and the normal equations that both stages solve.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::slam {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A residual of `Rows` components linearised at the present estimate: e(x) ≈ error + Σ_k jacobian[k]·x[block[k]].
/// Every unknown of both stages lives in a block of six.
template <int Rows>
struct LinearResidual {
  static constexpr int kMaxBlocks = 12;
  Eigen::Matrix<double, Rows, 1> error = Eigen::Matrix<double, Rows, 1>::Zero();
  std::array<int, kMaxBlocks> block{};
  std::array<Eigen::Matrix<double, Rows, 6>, kMaxBlocks> jacobian{};
  int blocks = 0;

  /// The Jacobian of `index`, zero at first; contributions of one block from two places add up.
  Eigen::Matrix<double, Rows, 6>& at(int index) {
    for (int k = 0; k < blocks; ++k)
      if (block[k] == index) return jacobian[k];
    block[blocks] = index;
    jacobian[blocks].setZero();
    return jacobian[blocks++];
  }
};

/// A scalar residual that acts on the four neighbouring blocks first … first+3 of a spline, and perhaps on one block
/// more.
struct SplineResidual {
  double error = 0;
  int first = 0;
  std::array<Vector6d, 4> row{};  ///< transposed Jacobians
  int extra = -1;                 ///< a block outside the spline; -1: none
  Vector6d extra_row = Vector6d::Zero();

  LinearResidual<1> linear() const;
};

/// Normal equations H x = −g of a weighted least-squares problem with blocks of six unknowns, the upper triangle of H
/// held by blocks. Small systems (the window) index blocks directly and factor densely; large ones (the global stage)
/// keep only the blocks that occur and factor sparsely. Sums run in the order of the calls.
class BlockSystem {
 public:
  enum class Storage { dense, sparse };
  BlockSystem(int blocks, Storage storage);

  /// Sets every sum to zero and keeps the sparsity pattern.
  void clear();

  template <int Rows>
  void add(const LinearResidual<Rows>& r, double weight) {
    for (int i = 0; i < r.blocks; ++i) {
      const Eigen::Matrix<double, 6, Rows> jt = weight * r.jacobian[i].transpose();
      gradient_.template segment<6>(6 * r.block[i]).noalias() += jt * r.error;
      for (int j = 0; j < r.blocks; ++j) {
        if (r.block[i] > r.block[j]) continue;
        at(r.block[i], r.block[j]).noalias() += jt * r.jacobian[j];
      }
    }
  }

  void add(const SplineResidual& r, double weight);

  /// Adds only what ties the two sides of a residual with the Jacobian a + b: weight·(aᵀb + bᵀa). With both sides added
  /// as residuals of their own, to this or to another system, the sum is that of the residual.
  void add_coupling(const SplineResidual& a, const SplineResidual& b, double weight);

  /// A prior x[block] ~ N(offset, diag(1/information)): adds its normal equations.
  void add_prior(int block, const Vector6d& offset, const Vector6d& information);

  /// Adds another system of the same size.
  void add(const BlockSystem& other);

  /// Solves for x by Cholesky factorisation. Errors: bad_input where H is not positive definite.
  Result<Eigen::VectorXd> solve() const;

  /// Solves for x with H + `coupling`, by conjugate gradients preconditioned by the factor of H. Loop closures
  /// tie every part of a drive to every other: a factor of the whole would be full, one of the chain alone is sparse.
  /// Errors: bad_input where either is not positive definite.
  Result<Eigen::VectorXd> solve(const BlockSystem& coupling) const;

  /// Marginal covariances: for each asked block b the part of H⁻¹ that belongs to the blocks b … b+width-1.
  Result<std::vector<Eigen::MatrixXd>> marginals(const std::vector<int>& blocks, int width = 1) const;

  int blocks() const { return blocks_; }

 private:
  Matrix6d& at(int row, int column);                                        // row ≤ column
  void couple(int a, const Vector6d& row_a, int b, const Vector6d& row_b);  // adds aᵀb and bᵀa
  std::size_t dense_index(int row, int column) const {
    return static_cast<std::size_t>(column) * (static_cast<std::size_t>(column) + 1) / 2 +
           static_cast<std::size_t>(row);
  }
  Eigen::MatrixXd dense_matrix() const;
  bool factor_densely() const;
  void grow_slots();
  std::size_t slot_of(int row, int column) const;  // where (row, column) is or belongs

  int blocks_;
  Storage storage_;
  Eigen::VectorXd gradient_;
  std::vector<Matrix6d> values_;
  std::vector<std::pair<int, int>> where_;  // sparse: row and column of values_[k]
  // Sparse: from (row, column) to k + 1; 0 = free. Blocks near the diagonal, which every residual of the chain touches,
  // stand in a table, the others are found by open addressing in a power of two of slots.
  static constexpr int kBand = 4;
  std::vector<std::uint32_t> band_, slots_;
};

}  // namespace rayfield::slam
