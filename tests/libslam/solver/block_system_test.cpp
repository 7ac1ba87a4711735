#include "libslam/solver/block_system.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <vector>

#include "tests/libslam/linear_residuals.h"

namespace rayfield::slam {
namespace {

using testing::dense;
using testing::Functor;
using testing::small_random;

TEST(BlockSystem, SolvesLikeCeresOnALinearProblemInBothStorages) {
  const int blocks = 5;
  std::vector<LinearResidual<3>> rows;
  for (unsigned k = 0; k < 40; ++k) {
    LinearResidual<3> r;
    r.error = small_random(3, 100 + k, 1);
    for (int b : {static_cast<int>(k) % blocks, static_cast<int>(k * k + 1) % blocks}) {
      const Eigen::VectorXd v = small_random(18, 200 + 7 * k + static_cast<unsigned>(b), 1);
      r.at(b) += Eigen::Map<const Eigen::Matrix<double, 3, 6>>(v.data());
    }
    rows.push_back(r);
  }
  Eigen::MatrixXd stacked(120, 6 * blocks);
  Eigen::VectorXd errors(120);
  for (int k = 0; k < 40; ++k)
    stacked.middleRows(3 * k, 3) = dense(rows[k], blocks), errors.segment<3>(3 * k) = rows[k].error;
  ceres::Problem problem;
  Eigen::VectorXd oracle = Eigen::VectorXd::Zero(6 * blocks);
  auto* cost = new ceres::DynamicNumericDiffCostFunction<Functor>(
      new Functor{[&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return stacked * x + errors; }, 6 * blocks});
  cost->AddParameterBlock(6 * blocks);
  cost->SetNumResiduals(120);
  problem.AddResidualBlock(cost, nullptr, oracle.data());
  ceres::Solver::Options options;
  options.function_tolerance = 1e-16, options.gradient_tolerance = 1e-14, options.parameter_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (const auto storage : {BlockSystem::Storage::dense, BlockSystem::Storage::sparse}) {
    BlockSystem system(blocks, storage);
    for (const auto& r : rows) system.add(r, 1.0);
    const auto x = system.solve();
    ASSERT_TRUE(x) << x.error().line();
    EXPECT_LT((*x - oracle).cwiseAbs().maxCoeff(), 1e-6);
    const auto covariance = system.marginals({2});
    ASSERT_TRUE(covariance);
    const Eigen::MatrixXd inverse = (stacked.transpose() * stacked).inverse();
    EXPECT_LT(((*covariance)[0] - inverse.block<6, 6>(12, 12)).cwiseAbs().maxCoeff(), 1e-9);
  }
}

// Ceres comes compiled, and takes Eigen's functions from here where they have the same names: under AddressSanitizer,
// too, both have to agree on how Eigen's memory is taken and given back (cmake/RayfieldRoom.cmake).
TEST(BlockSystem, IsInOneProgramWithCeresThatFactorsWithEigen) {
  void* (*volatile named)(std::size_t) = &Eigen::internal::aligned_malloc;  // so that Ceres takes this one
  ASSERT_NE(named, nullptr);
  BlockSystem system(2, BlockSystem::Storage::sparse);
  for (int b = 0; b < 2; ++b) {
    for (int half = 0; half < 2; ++half) {
      LinearResidual<3> r;
      r.error = Eigen::Vector3d::Ones();
      r.at(b).middleCols(3 * half, 3) = Eigen::Matrix3d::Identity();
      system.add(r, 1.0);
    }
  }
  const auto x = system.solve();
  ASSERT_TRUE(x) << x.error().line();
  Eigen::VectorXd oracle = Eigen::VectorXd::Zero(12);
  auto* cost = new ceres::DynamicNumericDiffCostFunction<Functor>(
      new Functor{[](const Eigen::VectorXd& v) -> Eigen::VectorXd { return v + Eigen::VectorXd::Ones(12); }, 12});
  cost->AddParameterBlock(12);
  cost->SetNumResiduals(12);
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, oracle.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_LT((*x - oracle).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(BlockSystem, SolvesIterativelyWhatItSolvesDirectly) {
  // A chain of blocks, each tied to the next, and ties across it like those of revisits.
  const int blocks = 64, extra = blocks - 1;
  BlockSystem whole(blocks, BlockSystem::Storage::sparse), chain = whole, coupling = whole;
  const auto side = [](int first, unsigned seed, double error, int more) {
    SplineResidual r;
    r.error = error, r.first = first, r.extra = more;
    for (unsigned k = 0; k < 4; ++k) r.row[k] = small_random(6, seed + k, 1);
    if (more >= 0) r.extra_row = small_random(6, seed + 4, 1);
    return r;
  };
  for (int b = 0; b < blocks; ++b) {
    const Vector6d offset = small_random(6, 10 + static_cast<unsigned>(b), 1);
    for (BlockSystem* s : {&whole, &chain}) s->add_prior(b, offset, Vector6d::Constant(1e-2));
    for (unsigned k = 0; k < 12 && b + 1 < blocks; ++k) {
      LinearResidual<1> r;
      r.error[0] = 0.3;
      r.at(b) = small_random(6, 1000 * k + static_cast<unsigned>(b), 1).transpose();
      r.at(b + 1) = small_random(6, 5000 * k + static_cast<unsigned>(b), 1).transpose();
      for (BlockSystem* s : {&whole, &chain}) s->add(r, 10);
    }
  }
  for (int k = 0; k < 200; ++k) {
    const int i = (7 * k) % 60, j = (11 * k + 29) % 60;  // in any order; they may overlap
    const double error = 0.01 * k;
    const auto a = side(i, 90000 + 10 * static_cast<unsigned>(k), error, k % 2 == 0 ? extra : -1);
    const auto b = side(j, 95000 + 10 * static_cast<unsigned>(k), error, k % 3 == 0 ? extra : -1);
    LinearResidual<1> r = a.linear();
    const LinearResidual<1> other = b.linear();
    for (int n = 0; n < other.blocks; ++n) r.at(other.block[n]) += other.jacobian[n];
    whole.add(r, 2);
    chain.add(a, 2), chain.add(b, 2), coupling.add_coupling(a, b, 2);
  }
  const auto direct = whole.solve(), iterative = chain.solve(coupling);
  ASSERT_TRUE(direct) << direct.error().line();
  ASSERT_TRUE(iterative) << iterative.error().line();
  EXPECT_LT((*direct - *iterative).norm(), 1e-5 * direct->norm());
}

TEST(BlockSystem, SaysThatASingularSystemIsBadInput) {
  BlockSystem system(2, BlockSystem::Storage::sparse);
  system.add_prior(0, Vector6d::Zero(), Vector6d::Ones());
  system.add_prior(1, Vector6d::Zero(), Vector6d::Zero());
  const auto x = system.solve();
  ASSERT_FALSE(x);
  EXPECT_EQ(x.error().code, ErrorCode::bad_input);
}

}  // namespace
}  // namespace rayfield::slam
