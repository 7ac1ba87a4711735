#include "libslam/solver/block_system.h"

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

constexpr double kDenseShare = 0.2;  // of all blocks filled: from here on a dense factor is the faster one

struct BlockPosition {
  int row, column;
  std::size_t value;
};

// Blocks by column, then row: sums over them do not depend on the order of insertion.
std::vector<BlockPosition> sorted_blocks(const std::vector<std::pair<int, int>>& where) {
  std::vector<BlockPosition> out;
  out.reserve(where.size());
  for (std::size_t k = 0; k < where.size(); ++k) out.push_back({where[k].first, where[k].second, k});
  std::sort(out.begin(), out.end(), [](const BlockPosition& a, const BlockPosition& b) {
    return a.column != b.column ? a.column < b.column : a.row < b.row;
  });
  return out;
}

// Upper triangle of the blocks given (sorted).
Sparse sparse_matrix(int blocks, const std::vector<BlockPosition>& where, const std::vector<Matrix6d>& values) {
  Sparse m(6 * blocks, 6 * blocks);
  m.reserve(static_cast<Eigen::Index>(36 * where.size()));
  std::size_t begin = 0;
  for (int b = 0; b < blocks; ++b) {
    std::size_t end = begin;
    while (end < where.size() && where[end].column == b) ++end;
    for (int c = 0; c < 6; ++c) {
      m.startVec(6 * b + c);
      for (std::size_t k = begin; k < end; ++k)
        for (int r = 0; r < 6; ++r)
          if (where[k].row < b || r <= c) m.insertBack(6 * where[k].row + r, 6 * b + c) = values[where[k].value](r, c);
    }
    begin = end;
  }
  m.finalize();
  return m;
}

// out += H·v.
void add_product(const std::vector<BlockPosition>& where, const std::vector<Matrix6d>& values, const Eigen::VectorXd& v,
                 Eigen::VectorXd& out) {
  for (const BlockPosition& w : where) {
    const Matrix6d& h = values[w.value];
    out.segment<6>(6 * w.row).noalias() += h * v.segment<6>(6 * w.column);
    if (w.row < w.column) out.segment<6>(6 * w.column).noalias() += h.transpose() * v.segment<6>(6 * w.row);
  }
}

}  // namespace

LinearResidual<1> SplineResidual::linear() const {
  LinearResidual<1> out;
  out.error[0] = error;
  for (int k = 0; k < 4; ++k) out.at(first + k) += row[k].transpose();
  if (extra >= 0) out.at(extra) += extra_row.transpose();
  return out;
}

BlockSystem::BlockSystem(int blocks, Storage storage)
    : blocks_(blocks), storage_(storage), gradient_(Eigen::VectorXd::Zero(6 * blocks)) {
  if (storage == Storage::dense)
    values_.assign(dense_index(0, blocks), Matrix6d::Zero());
  else
    slots_.assign(1024, 0), band_.assign(static_cast<std::size_t>(kBand * blocks), 0);
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
    if (where_[k].second - where_[k].first >= kBand)
      slots_[slot_of(where_[k].first, where_[k].second)] = static_cast<std::uint32_t>(k + 1);
}

Matrix6d& BlockSystem::at(int row, int column) {
  if (storage_ == Storage::dense) return values_[dense_index(row, column)];
  const bool in_band = column - row < kBand;
  std::uint32_t& number =
      in_band ? band_[static_cast<std::size_t>(kBand * row + column - row)] : slots_[slot_of(row, column)];
  if (number != 0) return values_[number - 1];
  values_.emplace_back(Matrix6d::Zero());
  where_.emplace_back(row, column);
  number = static_cast<std::uint32_t>(values_.size());
  if (!in_band && 2 * values_.size() > slots_.size()) grow_slots();
  return values_.back();
}

void BlockSystem::add_prior(int block, const Vector6d& offset, const Vector6d& information) {
  at(block, block).diagonal() += information;
  gradient_.segment<6>(6 * block) -= information.cwiseProduct(offset);
}

void BlockSystem::add(const SplineResidual& r, double weight) {
  if (r.extra >= 0) return add(r.linear(), weight);
  for (int j = 0; j < 4; ++j) {
    const Vector6d weighted = weight * r.row[j];
    gradient_.segment<6>(6 * (r.first + j)) += r.error * weighted;
    for (int i = 0; i <= j; ++i) at(r.first + i, r.first + j).noalias() += r.row[i] * weighted.transpose();
  }
}

void BlockSystem::couple(int a, const Vector6d& row_a, int b, const Vector6d& row_b) {
  if (a < b) {
    at(a, b).noalias() += row_a * row_b.transpose();
  } else {
    Matrix6d& block = at(b, a);
    block.noalias() += row_b * row_a.transpose();
    if (a == b) block.noalias() += row_a * row_b.transpose();
  }
}

void BlockSystem::add_coupling(const SplineResidual& a, const SplineResidual& b, double weight) {
  for (int i = 0; i < 4; ++i) {
    const Vector6d weighted = weight * a.row[i];
    for (int j = 0; j < 4; ++j) couple(a.first + i, weighted, b.first + j, b.row[j]);
    if (b.extra >= 0) couple(a.first + i, weighted, b.extra, b.extra_row);
  }
  if (a.extra < 0) return;
  const Vector6d weighted = weight * a.extra_row;
  for (int j = 0; j < 4; ++j) couple(a.extra, weighted, b.first + j, b.row[j]);
  if (b.extra >= 0) couple(a.extra, weighted, b.extra, b.extra_row);
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
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(6 * blocks_, 6 * blocks_);
  const auto put = [&h](int r, int c, const Matrix6d& value) {
    h.block<6, 6>(6 * r, 6 * c) = value;
    if (r < c) h.block<6, 6>(6 * c, 6 * r) = value.transpose();
  };
  if (storage_ == Storage::sparse) {
    for (std::size_t k = 0; k < where_.size(); ++k) put(where_[k].first, where_[k].second, values_[k]);
    return h;
  }
  for (int c = 0; c < blocks_; ++c)
    for (int r = 0; r <= c; ++r) put(r, c, values_[dense_index(r, c)]);
  return h;
}

bool BlockSystem::factor_densely() const {
  const double all = 0.5 * blocks_ * (blocks_ + 1.0);
  return storage_ == Storage::dense || static_cast<double>(where_.size()) > kDenseShare * all;
}

Result<Eigen::VectorXd> BlockSystem::solve() const {
  if (!gradient_.allFinite()) return singular();
  Eigen::VectorXd x;
  if (factor_densely()) {
    const Eigen::LLT<Eigen::MatrixXd> llt(dense_matrix());
    if (llt.info() != Eigen::Success) return singular();
    x = llt.solve(-gradient_);
  } else {
    const SparseSolver ldlt(sparse_matrix(blocks_, sorted_blocks(where_), values_));
    if (ldlt.info() != Eigen::Success || ldlt.vectorD().minCoeff() <= 0) return singular();
    x = ldlt.solve(-gradient_);
  }
  if (!x.allFinite()) return singular();
  return x;
}

// Preconditioned conjugate gradients (Saad, Iterative Methods for Sparse Linear Systems, algorithm 9.1).
Result<Eigen::VectorXd> BlockSystem::solve(const BlockSystem& coupling) const {
  constexpr int kMaxIterations = 2000;
  constexpr double kTolerance = 1e-7;
  if (!gradient_.allFinite()) return singular();
  const std::vector<BlockPosition> own = sorted_blocks(where_), other = sorted_blocks(coupling.where_);
  const SparseSolver preconditioner(sparse_matrix(blocks_, own, values_));
  if (preconditioner.info() != Eigen::Success || preconditioner.vectorD().minCoeff() <= 0) return singular();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(gradient_.size()), q = x, r = -gradient_, z = preconditioner.solve(r),
                  p = z;
  double energy = r.dot(z);
  const double goal = energy * kTolerance * kTolerance;
  for (int k = 0; k < kMaxIterations && energy > goal; ++k) {
    q.setZero();
    add_product(own, values_, p, q);
    add_product(other, coupling.values_, p, q);
    const double curvature = p.dot(q);
    if (!(curvature > 0)) return singular();
    x += energy / curvature * p;
    r -= energy / curvature * q;
    z = preconditioner.solve(r);
    const double next = r.dot(z);
    p = z + next / energy * p;
    energy = next;
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
  if (factor_densely()) {
    const Eigen::LLT<Eigen::MatrixXd> llt(dense_matrix());
    if (llt.info() != Eigen::Success) return singular();
    gather(llt);
  } else {
    const SparseSolver ldlt(sparse_matrix(blocks_, sorted_blocks(where_), values_));
    if (ldlt.info() != Eigen::Success || ldlt.vectorD().minCoeff() <= 0) return singular();
    gather(ldlt);
  }
  return out;
}

}  // namespace rayfield::slam
