#include "libslam/odometry/window.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libslam/solver/surfel_terms.h"
#include "libslam/surfels/surfel_match.h"
#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr int kImuGroup = 5;  // samples whose mean is one IMU residual: 0.05 s, far below the knot spacing
constexpr std::size_t kParts = 2;
constexpr double kFixed = 1e14;  // information that holds an unknown

double mix_log(double a, double b, double f) { return a * std::pow(b / a, std::clamp(f, 0.0, 1.0)); }

void add_imu_terms(const ResidualFrame& frame, const ImuGrid& imu, const InertialNoise& noise,
                   const InertialState& state, int bias_block, int first, int last, BlockSystem& system) {
  const BiasWeights bias{{bias_block, bias_block}, {1, 0}};
  const double duration = kImuGroup * frame.track->step_s;
  const double gyro_weight = 1 / noise.gyro_variance(duration), accel_weight = 1 / noise.accel_variance(duration);
  for (int k = std::max(first, 1); k + kImuGroup < last; k += kImuGroup) {
    system.add(gyro_residual(frame, bias, state, imu.gyro(), k, kImuGroup), gyro_weight);
    system.add(accel_residual(frame, bias, state, imu.accel(), k, kImuGroup), accel_weight);
  }
}

void describe(const SurfelSums& sums, WindowStats& stats) {
  stats.matches = static_cast<int>(sums.matches);
  stats.inlier_fraction = sums.matches == 0 ? 0 : static_cast<double>(sums.inliers) / static_cast<double>(sums.matches);
  stats.surfel_rms_m = sums.rms_m();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(sums.information);
  stats.weakest_sigma_m = 1 / std::sqrt(std::max(eigen.eigenvalues()[0], 1e-12));
  stats.weakest_direction = eigen.eigenvectors().col(0);
}

// Joins the window to the trajectory before it, or fixes the gauge of the first one.
void add_boundary(const ResidualFrame& frame, const WindowPrior& prior, double start_s, BlockSystem& system) {
  if (!prior.first) {
    for (int j = 0; j < 3; ++j)
      system.add_prior(frame.first_knot_block + j, Vector6d::Zero(), Vector6d::Constant(kFixed));
    return;
  }
  // No correction at the beginning. That includes tilt, whose error appears as the direction of gravity.
  const SplineWeights w = frame.spline.weights(start_s);
  const Eigen::Vector3d p = frame.track->pose(start_s).translation;
  LinearResidual<6> r;
  for (int j = 0; j < 4; ++j) {
    auto& block = r.at(frame.first_knot_block + w.first + j);
    block.diagonal().array() += w.value[j] * 1e4;
    block.topRightCorner<3, 3>() -= w.value[j] * 1e4 * hat(p - frame.anchor[w.first + j]);
  }
  system.add(r, 1);
  // A knot that no data constrain must not make the system singular.
  for (int j = 0; j < frame.spline.knots(); ++j)
    system.add_prior(frame.first_knot_block + j, Vector6d::Zero(), Vector6d::Constant(1e-4));
}

// The joint prior of biases and gravity: e = L⁻¹·(x − x₀) with covariance L·Lᵀ.
void add_inertial_prior(const WindowPrior& prior, const InertialState& before, const InertialState& now, int bias_block,
                        int extra_block, BlockSystem& system) {
  const Matrix8d whitening = prior.covariance.llt().matrixL().solve(Matrix8d::Identity());
  Eigen::Matrix<double, 8, 1> moved;
  moved << now.gyro_bias - before.gyro_bias, now.accel_bias - before.accel_bias,
      (now.gravity - before.gravity).head<2>();
  LinearResidual<8> r;
  r.error = whitening * moved;
  r.at(bias_block) = whitening.leftCols<6>();
  r.at(extra_block).leftCols<2>() = whitening.rightCols<2>();
  system.add(r, 1);
  Vector6d rest = Vector6d::Constant(kFixed);
  rest.head<2>().setZero();
  system.add_prior(extra_block, Vector6d::Zero(), rest);
}

// Scales of an iteration: `f` grows from 0 to 1 while matches and weights are annealed. Later windows begin with a
// trajectory that is right except for the newest second: they anneal over the second half only.
double annealing(bool first_window, int iteration, int iterations) {
  return first_window ? iteration / std::max(1.0, iterations - 5.0)
                      : 0.5 + 0.5 * iteration / std::max(1.0, iterations - 2.0);
}

// Matches surfels at the present trajectory and adds their residuals to `system`, which is empty. `parts` is scratch of
// the same size: a fixed number of partial sums, so that threads do not change the result.
SurfelSums add_surfels(const ResidualFrame& frame, std::span<const Surfel> surfels, const Eigen::Vector3d& origin,
                       const SlamOptions& options, double f, std::vector<BlockSystem>& parts, BlockSystem& system) {
  const int threads = thread_count(options.threads);
  const auto placed = place_surfels(surfels, *frame.track, origin, threads);
  MatchQuery query;
  query.radius_voxels = mix_log(options.match.first_radius_voxels, options.match.last_radius_voxels, f);
  query.normal_scale_m = options.match.normal_scale_m;
  query.min_gap_s = options.match.min_time_gap_s;
  const auto matches = mutual_matches(placed, options.surfels.voxel_size_m, query, threads);
  const double cauchy = mix_log(options.match.first_cauchy, options.match.last_cauchy, f);
  std::array<SurfelSums, kParts> sums_of;
  parallel_each(kParts, threads, [&](std::size_t part, int) {
    const std::size_t begin = matches.size() * part / kParts, end = matches.size() * (part + 1) / kParts;
    parts[part].clear();
    sums_of[part] = add_surfel_terms(frame, surfels, std::span(matches).subspan(begin, end - begin),
                                     {options.match.sigma_m, cauchy}, parts[part], parts[part]);
  });
  SurfelSums sums;
  for (std::size_t part = 0; part < kParts; ++part) system.add(parts[part]), sums.add(sums_of[part]);
  return sums;
}

// Adds the solution's corrections of biases and gravity, whose length stays as it is.
void correct_inertial_state(const Eigen::VectorXd& x, int bias_block, int extra_block, InertialState& state) {
  state.gyro_bias += x.segment<3>(6 * bias_block);
  state.accel_bias += x.segment<3>(6 * bias_block + 3);
  const double length = state.gravity.norm();
  state.gravity.head<2>() += x.segment<2>(6 * extra_block);
  state.gravity.z() = std::sqrt(length * length - state.gravity.head<2>().squaredNorm());
}

}  // namespace

double InertialNoise::gyro_variance(double duration_s) const {
  const double sigma = gyro_density * gyro_scale;
  return sigma * sigma / duration_s;
}
double InertialNoise::accel_variance(double duration_s) const {
  const double sigma = accel_density * accel_scale;
  return sigma * sigma / duration_s;
}

// Iterates: matches surfels, builds the normal equations of surfels, IMU, boundary and prior, solves, corrects.
Result<WindowStats> solve_window(PoseTrack& track, const ImuGrid& imu, std::span<const Surfel> surfels,
                                 const SlamOptions& options, const InertialNoise& noise, const WindowPrior& prior,
                                 int first_sample, int last_sample, InertialState& state) {
  ResidualFrame frame;
  frame.track = &track;
  frame.spline.start_s = first_sample * track.step_s;
  const double length = (last_sample - first_sample) * track.step_s;
  frame.spline.spans = std::max(1, static_cast<int>(std::lround(length / options.window.knot_step_s)));
  frame.spline.step_s = length / frame.spline.spans;
  const int bias_block = frame.spline.knots(), extra_block = bias_block + 1;
  frame.extra_block = extra_block;
  BlockSystem system(extra_block + 1, BlockSystem::Storage::dense);
  std::vector<BlockSystem> parts(kParts, system);

  WindowStats stats;
  stats.start_s = frame.spline.start_s, stats.end_s = stats.start_s + length;
  const InertialState before = state;
  const int iterations = prior.first ? options.window.first_iterations : options.window.max_iterations;
  for (int it = 0; it < iterations; ++it) {
    const double f = annealing(prior.first, it, iterations);
    system.clear();
    frame.anchor = anchors_of(frame.spline, track);
    describe(add_surfels(frame, surfels, track.position[first_sample], options, f, parts, system), stats);
    add_imu_terms(frame, imu, noise, state, bias_block, first_sample, last_sample, system);
    add_boundary(frame, prior, stats.start_s, system);
    add_inertial_prior(prior, before, state, bias_block, extra_block, system);

    RAYFIELD_ASSIGN(const Eigen::VectorXd x, system.solve());
    apply_correction(frame, x.head(6 * frame.spline.knots()), first_sample, last_sample, track);
    correct_inertial_state(x, bias_block, extra_block, state);
    double largest = 0;
    for (int j = 0; j < frame.spline.knots(); ++j) largest = std::max(largest, x.segment<3>(6 * j).norm());
    if (f >= 1 && largest < options.window.converged_m) break;
  }
  RAYFIELD_ASSIGN(const std::vector<Eigen::MatrixXd> joint, system.marginals({bias_block}, 2));
  stats.covariance = joint[0].topLeftCorner<8, 8>();
  return stats;
}

}  // namespace rayfield::slam
