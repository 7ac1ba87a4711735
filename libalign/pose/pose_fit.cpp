#include "libalign/pose/pose_fit.h"

#include <ceres/ceres.h>

#include <array>

namespace rayfield::align {
namespace {

constexpr double kSigma = 0.02, kCauchy = 1.5;  // m; in units of kSigma

// Residual of one match: (R(yaw)·p + t − q) / σ, all relative to the pivot.
struct MatchResidual {
  Eigen::Vector2d p, q;
  template <class T>
  bool operator()(const T* yaw, const T* shift, T* residual) const {
    using std::cos, std::sin;
    const T c = cos(yaw[0]), s = sin(yaw[0]);
    residual[0] = (c * p.x() - s * p.y() + shift[0] - q.x()) / kSigma;
    residual[1] = (s * p.x() + c * p.y() + shift[1] - q.y()) / kSigma;
    return true;
  }
};

PlanShift solve(const LandmarkPair& pair, const std::vector<Match>& matches, const PlanShift& start) {
  double yaw = start.yaw_rad;
  std::array<double, 2> shift = {start.shift.x(), start.shift.y()};
  ceres::Problem problem;
  for (const Match& m : matches) {
    const Eigen::Vector2d p = pair.scan.uprights[static_cast<std::size_t>(m.scan)].position - start.pivot;
    const Eigen::Vector2d q = pair.reference.uprights[static_cast<std::size_t>(m.reference)].position - start.pivot;
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<MatchResidual, 2, 1, 2>(new MatchResidual{p, q}),
                             new ceres::CauchyLoss(kCauchy), &yaw, shift.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 30;
  options.num_threads = 1;  // the same sums at any number of threads
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return start;
  PlanShift fitted = start;
  fitted.yaw_rad = yaw;
  fitted.shift.head<2>() << shift[0], shift[1];
  return fitted;
}

}  // namespace

PlanShift fit_pose(const LandmarkPair& pair, const PlanShift& start) {
  PlanShift pose = start;
  for (const double radius_m : {0.7, 0.4, 0.25, 0.15, 0.15}) {
    const std::vector<Match> matches = match_uprights(pair, pose, radius_m);
    if (matches.size() < 3) break;
    pose = solve(pair, matches, pose);
  }
  pose.shift.z() = compare_ground(pair, pose).offset_m;
  return pose;
}

}  // namespace rayfield::align
