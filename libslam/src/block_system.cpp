#include "block_system.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>

namespace rayfield::slam {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
using SparseSolver = Eigen::SimplicialLDLT<Sparse, Eigen::Upper, Eigen::AMDOrdering<int>>;

tl::unexpected<Error> singular() {
  return fail(ErrorCode::bad_input, "cannot solve for the trajectory", "normal equations",
              "they are singular or not finite: the sensors do not determine the motion",
              "check the IMU units and the extrinsics in the rig file");
}

// Upper triangle by columns; blocks are sorted so that the matrix does not depend on the order of insertion.
Sparse sparse_matrix(int blocks, const std::vector<std::pair<int, int>>& where, const std::vector<Matrix6d>& values) {
  std::vector<std::vector<std::pair<int, std::size_t>>> column(static_cast<std::size_t>(blocks));
  for (std::size_t k = 0; k < where.size(); ++k)
    column[static_cast<std::size_t>(where[k].second)].emplace_back(where[k].first, k);
  Sparse m(6 * blocks, 6 * blocks);
  m.reserve(static_cast<Eigen::Index>(36 * where.size()));
  for (int b = 0; b < blocks; ++b) {
    auto& rows = column[static_cast<std::size_t>(b)];
    std::sort(rows.begin(), rows.end());
    for (int c = 0; c < 6; ++c) {
      m.startVec(6 * b + c);
      for (const auto& [row, k] : rows)
        for (int r = 0; r < 6; ++r)
          if (row < b || r <= c) m.insertBack(6 * row + r, 6 * b + c) = values[k](r, c);
    }
  }
  m.finalize();
  return m;
}

}  // namespace

BlockSystem::BlockSystem(int blocks, Storage storage)
    : blocks_(blocks), storage_(storage), gradient_(Eigen::VectorXd::Zero(6 * blocks)) {
  if (storage == Storage::dense)
    values_.assign(dense_index(0, blocks), Matrix6d::Zero());
  else
    slots_.assign(1024, 0);
}

void BlockSystem::clear() {
  gradient_.setZero();
  for (Matrix6d& m : values_) m.setZero();
}

std::size_t BlockSystem::slot_of(int row, int column) const {
  std::uint64_t h = static_cast<std::uint64_t>(static_cast<std::uint32_t>(row)) * 0x9e3779b97f4a7c15ULL +
                    static_cast<std::uint64_t>(static_cast<std::uint32_t>(column)) * 0xc2b2ae3d27d4eb4fULL;
  h ^= h >> 32;
  std::size_t slot = h & (slots_.size() - 1);
  while (slots_[slot] != 0 && where_[slots_[slot] - 1] != std::pair(row, column))
    slot = (slot + 1) & (slots_.size() - 1);
  return slot;
}

void BlockSystem::grow_slots() {
  slots_.assign(slots_.size() * 2, 0);
  for (std::size_t k = 0; k < where_.size(); ++k)
    slots_[slot_of(where_[k].first, where_[k].second)] = static_cast<std::uint32_t>(k + 1);
}

Matrix6d& BlockSystem::at(int row, int column) {
  if (storage_ == Storage::dense) return values_[dense_index(row, column)];
  const std::size_t slot = slot_of(row, column);
  if (slots_[slot] != 0) return values_[slots_[slot] - 1];
  values_.emplace_back(Matrix6d::Zero());
  where_.emplace_back(row, column);
  slots_[slot] = static_cast<std::uint32_t>(values_.size());
  if (2 * values_.size() > slots_.size()) grow_slots();
  return values_.back();
}

void BlockSystem::add_prior(int block, const Vector6d& offset, const Vector6d& information) {
  at(block, block).diagonal() += information;
  gradient_.segment<6>(6 * block) -= information.cwiseProduct(offset);
}

void BlockSystem::add(const BlockSystem& other) {
  gradient_ += other.gradient_;
  if (storage_ == Storage::dense) {
    for (std::size_t k = 0; k < values_.size(); ++k) values_[k] += other.values_[k];
    return;
  }
  for (std::size_t k = 0; k < other.values_.size(); ++k)
    at(other.where_[k].first, other.where_[k].second) += other.values_[k];
}

Eigen::MatrixXd BlockSystem::dense_matrix() const {
  Eigen::MatrixXd h(6 * blocks_, 6 * blocks_);
  for (int c = 0; c < blocks_; ++c)
    for (int r = 0; r <= c; ++r) {
      h.block<6, 6>(6 * r, 6 * c) = values_[dense_index(r, c)];
      if (r < c) h.block<6, 6>(6 * c, 6 * r) = values_[dense_index(r, c)].transpose();
    }
  return h;
}

Result<Eigen::VectorXd> BlockSystem::solve() const {
  if (!gradient_.allFinite()) return singular();
  Eigen::VectorXd x;
  if (storage_ == Storage::dense) {
    const Eigen::LLT<Eigen::MatrixXd> llt(dense_matrix());
    if (llt.info() != Eigen::Success) return singular();
    x = llt.solve(-gradient_);
  } else {
    const SparseSolver ldlt(sparse_matrix(blocks_, where_, values_));
    if (ldlt.info() != Eigen::Success || ldlt.vectorD().minCoeff() <= 0) return singular();
    x = ldlt.solve(-gradient_);
  }
  if (!x.allFinite()) return singular();
  return x;
}

Result<std::vector<Eigen::MatrixXd>> BlockSystem::marginals(const std::vector<int>& blocks, int width) const {
  std::vector<Eigen::MatrixXd> out;
  const auto gather = [&](const auto& solver) {
    for (const int b : blocks) {
      Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(6 * blocks_, 6 * width);
      unit.middleRows(6 * b, 6 * width).setIdentity();
      const Eigen::MatrixXd column = solver.solve(unit);
      out.push_back(column.middleRows(6 * b, 6 * width));
    }
  };
  if (storage_ == Storage::dense) {
    const Eigen::LLT<Eigen::MatrixXd> llt(dense_matrix());
    if (llt.info() != Eigen::Success) return singular();
    gather(llt);
  } else {
    const SparseSolver ldlt(sparse_matrix(blocks_, where_, values_));
    if (ldlt.info() != Eigen::Success || ldlt.vectorD().minCoeff() <= 0) return singular();
    gather(ldlt);
  }
  return out;
}

}  // namespace rayfield::slam
