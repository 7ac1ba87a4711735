#include "libalign/warp/warp_fit.h"

#include <ceres/ceres.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "rayfield/core/median.h"

namespace rayfield::align {
namespace {

constexpr std::size_t kLeastMatches = 20, kFolds = 5;
constexpr double kUprightSigma = 0.012, kGroundSigma = 0.03;  // m
constexpr double kCauchy[] = {10, 2};  // in sigmas; wide first, so that a large drift is not taken for bad matches
constexpr double kGroundPatch = 3;     // m between heights that are used
constexpr double kSmallSigma = 0.3;    // m; keeps control points that nothing pulls at

// A place with a displacement that is known there, in plan or in height.
struct Pull {
  Eigen::Vector2d place;
  Eigen::Vector3d displacement;
  bool plan = true;  ///< false: the height only
};

// residual = (Σ wᵢ·cᵢ − d) / σ over some control points; linear, so that its Jacobian is the weights.
class LinearResidual : public ceres::CostFunction {
 public:
  LinearResidual(std::vector<double> weights, Eigen::VectorXd target, int first_component, double sigma)
      : weights_(std::move(weights)), target_(std::move(target)), first_(first_component), sigma_(sigma) {
    set_num_residuals(static_cast<int>(target_.size()));
    for (std::size_t i = 0; i < weights_.size(); ++i) mutable_parameter_block_sizes()->push_back(3);
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Index rows = target_.size();
    for (Eigen::Index r = 0; r < rows; ++r) {
      double sum = -target_(r);
      for (std::size_t i = 0; i < weights_.size(); ++i) sum += weights_[i] * parameters[i][first_ + r];
      residuals[r] = sum / sigma_;
    }
    for (std::size_t i = 0; jacobians != nullptr && i < weights_.size(); ++i) {
      if (jacobians[i] == nullptr) continue;
      std::fill(jacobians[i], jacobians[i] + 3 * rows, 0.0);
      for (Eigen::Index r = 0; r < rows; ++r) jacobians[i][3 * r + first_ + r] = weights_[i] / sigma_;
    }
    return true;
  }

 private:
  std::vector<double> weights_;
  Eigen::VectorXd target_;
  int first_;
  double sigma_;
};

Warp lattice_over(const std::vector<Pull>& pulls, double spacing_m) {
  Eigen::AlignedBox2d box;
  for (const Pull& pull : pulls) box.extend(pull.place);
  Warp warp;
  warp.spacing_m = spacing_m;
  const Eigen::Vector2d size = box.sizes();
  const Eigen::Vector2d spans = (size / spacing_m).array().ceil().max(1.0);
  warp.origin = box.min() - 0.5 * (spans * spacing_m - size);
  warp.nx = static_cast<int>(spans.x()) + 3, warp.ny = static_cast<int>(spans.y()) + 3;
  warp.control.assign(static_cast<std::size_t>(warp.nx * warp.ny), Eigen::Vector3d::Zero());
  return warp;
}

double* control_at(Warp& warp, int ix, int iy) {
  return warp.control[static_cast<std::size_t>(iy * warp.nx + ix)].data();
}

void add_pull(ceres::Problem& problem, Warp& warp, const Pull& pull, double cauchy) {
  const WarpWeights w = warp_weights(warp, pull.place);
  std::vector<double> weights;
  std::vector<double*> blocks;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      weights.push_back(w.x[i] * w.y[j]);
      blocks.push_back(control_at(warp, w.first_x + i, w.first_y + j));
    }
  const Eigen::VectorXd target =
      pull.plan ? Eigen::VectorXd(pull.displacement.head<2>()) : Eigen::VectorXd(pull.displacement.tail<1>());
  problem.AddResidualBlock(
      new LinearResidual(std::move(weights), target, pull.plan ? 0 : 2, pull.plan ? kUprightSigma : kGroundSigma),
      new ceres::CauchyLoss(cauchy), blocks);
}

void add_prior(ceres::Problem& problem, Warp& warp, double bend_sigma_m) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
  const auto add = [&](std::vector<double> weights, const std::vector<double*>& blocks, double sigma) {
    problem.AddResidualBlock(new LinearResidual(std::move(weights), zero, 0, sigma), nullptr, blocks);
  };
  for (int iy = 0; iy < warp.ny; ++iy)
    for (int ix = 0; ix < warp.nx; ++ix) {
      double* here = control_at(warp, ix, iy);
      add({1}, {here}, kSmallSigma);
      const bool in_x = ix > 0 && ix + 1 < warp.nx, in_y = iy > 0 && iy + 1 < warp.ny;
      if (in_x) add({1, -2, 1}, {control_at(warp, ix - 1, iy), here, control_at(warp, ix + 1, iy)}, bend_sigma_m);
      if (in_y) add({1, -2, 1}, {control_at(warp, ix, iy - 1), here, control_at(warp, ix, iy + 1)}, bend_sigma_m);
      if (ix + 1 < warp.nx && iy + 1 < warp.ny)
        add({1, -1, -1, 1},
            {here, control_at(warp, ix + 1, iy), control_at(warp, ix, iy + 1), control_at(warp, ix + 1, iy + 1)},
            bend_sigma_m);
    }
}

Warp solve(const std::vector<Pull>& pulls, const std::vector<bool>& left_out, const WarpOptions& options) {
  Warp warp = lattice_over(pulls, options.spacing_m);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  solver.max_num_iterations = 20;
  solver.num_threads = 1;  // the same sums at any number of threads
  solver.logging_type = ceres::SILENT;
  for (const double cauchy : kCauchy) {
    ceres::Problem problem;
    for (std::size_t i = 0; i < pulls.size(); ++i)
      if (!left_out[i]) add_pull(problem, warp, pulls[i], cauchy);
    add_prior(problem, warp, options.bend_sigma_m);
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) return {};
  }
  return warp;
}

std::vector<Pull> pulls_of(const LandmarkPair& pair, const PlanShift& pose, const std::vector<Match>& matches) {
  std::vector<Pull> pulls;
  for (const Match& m : matches) {
    const Eigen::Vector2d p = pose * pair.scan.uprights[static_cast<std::size_t>(m.scan)].position;
    const Eigen::Vector2d off = pair.reference.uprights[static_cast<std::size_t>(m.reference)].position - p;
    pulls.push_back({p, {off.x(), off.y(), 0}, true});
  }
  const Grid2<float>& from = pair.scan.ground;
  const Grid2<float>& to = pair.reference.ground;
  const int step = std::max(1, static_cast<int>(std::lround(kGroundPatch / from.cell_m)));
  for (int iy = 0; iy < from.ny; iy += step)
    for (int ix = 0; ix < from.nx; ix += step) {
      const double height = static_cast<double>(from.at(ix, iy));
      const Eigen::Vector2d p = pose * from.center(ix, iy);
      const Eigen::Vector2d at = (p - to.origin) / to.cell_m;
      const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
      if (!std::isfinite(height) || !to.contains(x, y)) continue;
      const double there = static_cast<double>(to.at(x, y));
      if (std::isfinite(there)) pulls.push_back({p, {0, 0, there - height - pose.shift.z()}, false});
    }
  return pulls;
}

}  // namespace

WarpFit fit_warp(const LandmarkPair& pair, const PlanShift& pose, const std::vector<Match>& matches,
                 const WarpOptions& options) {
  WarpFit fit;
  fit.rigid_left_out_m = fit.warped_left_out_m = std::numeric_limits<double>::quiet_NaN();
  if (!options.enabled || matches.size() < kLeastMatches) return fit;
  const std::vector<Pull> pulls = pulls_of(pair, pose, matches);
  std::vector<double> rigid, warped;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    std::vector<bool> left_out(pulls.size(), false);
    for (std::size_t i = fold; i < matches.size(); i += kFolds) left_out[i] = true;
    const Warp warp = solve(pulls, left_out, options);
    for (std::size_t i = fold; i < matches.size(); i += kFolds) {
      rigid.push_back(pulls[i].displacement.norm());
      warped.push_back((pulls[i].displacement - warp.at(pulls[i].place)).head<2>().norm());
    }
  }
  fit.rigid_left_out_m = median_of(rigid), fit.warped_left_out_m = median_of(warped);
  if (fit.warped_left_out_m <= (1 - options.min_gain) * fit.rigid_left_out_m)
    fit.warp = solve(pulls, std::vector<bool>(pulls.size(), false), options);
  return fit;
}

}  // namespace rayfield::align
