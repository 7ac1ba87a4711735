#include "libslam/odometry/window.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr int kImuGroup = 5;  // samples whose mean is one IMU residual: 0.05 s, far below the knot spacing
constexpr std::size_t kParts = 2;
constexpr double kFixed = 1e14;  // information that holds an unknown

double mix_log(double a, double b, double f) { return a * std::pow(b / a, std::clamp(f, 0.0, 1.0)); }

struct ImuSums {
  double gyro = 0, accel = 0;
  int count = 0;
};

ImuSums add_imu_terms(const ResidualFrame& frame, const ImuGrid& imu, const InertialNoise& noise,
                      const InertialState& state, int bias_block, int first, int last, BlockSystem& system) {
  ImuSums sums;
  const BiasWeights bias{{bias_block, bias_block}, {1, 0}};
  const double duration = kImuGroup * frame.track->step_s;
  const double gyro_weight = 1 / noise.gyro_variance(duration), accel_weight = 1 / noise.accel_variance(duration);
  for (int k = std::max(first, 1); k + kImuGroup < last; k += kImuGroup) {
    const auto g = gyro_residual(frame, bias, state, imu.gyro(), k, kImuGroup);
    const auto a = accel_residual(frame, bias, state, imu.accel(), k, kImuGroup);
    system.add(g, gyro_weight);
    system.add(a, accel_weight);
    sums.gyro += g.error.squaredNorm() * gyro_weight / 3;
    sums.accel += a.error.squaredNorm() * accel_weight / 3;
    ++sums.count;
  }
  return sums;
}

void describe(const SurfelSums& sums, WindowStats& stats) {
  stats.matches = static_cast<int>(sums.matches);
  stats.inlier_fraction = sums.matches == 0 ? 0 : static_cast<double>(sums.inliers) / static_cast<double>(sums.matches);
  stats.surfel_rms_m = sums.rms_m();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(sums.information);
  stats.weakest_sigma_m = 1 / std::sqrt(std::max(eigen.eigenvalues()[0], 1e-12));
  stats.weakest_direction = eigen.eigenvectors().col(0);
}

// Joins the window to what lies before it, or fixes the gauge of the first one.
void add_start(const ResidualFrame& frame, const WindowPrior& prior, double start_s, BlockSystem& system) {
  if (!prior.first) {
    for (int j = 0; j < 3; ++j)
      system.add_prior(frame.first_knot_block + j, Vector6d::Zero(), Vector6d::Constant(kFixed));
    return;
  }
  // No correction at the start. That holds its tilt too: what is wrong with it shows as the direction of gravity.
  const SplineWeights w = frame.spline.weights(start_s);
  const Eigen::Vector3d p = frame.track->pose(start_s).translation;
  LinearResidual<6> r;
  for (int j = 0; j < 4; ++j) {
    auto& block = r.at(frame.first_knot_block + w.first + j);
    block.diagonal().array() += w.value[j] * 1e4;
    block.topRightCorner<3, 3>() -= w.value[j] * 1e4 * hat(p - frame.anchor[w.first + j]);
  }
  system.add(r, 1);
  // A knot that no datum reaches must not make the system singular.
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

}  // namespace

double InertialNoise::gyro_variance(double duration_s) const {
  const double sigma = gyro_density * gyro_scale;
  return sigma * sigma / duration_s;
}
double InertialNoise::accel_variance(double duration_s) const {
  const double sigma = accel_density * accel_scale;
  return sigma * sigma / duration_s;
}

void set_spinner(const Rig& rig, ResidualFrame& frame) {
  if (!rig.spinner) return;
  frame.spin_axis = rig.imu_from_spinner.rotation * rig.spinner->axis;
  frame.spin_origin = rig.imu_from_spinner.translation;
}

void SurfelSums::add(const SurfelSums& other) {
  matches += other.matches, inliers += other.inliers;
  weights += other.weights, squares += other.squares;
  information += other.information;
}

SurfelSums add_surfel_terms(const ResidualFrame& frame, std::span<const Surfel> surfels,
                            std::span<const SurfelMatch> matches, const SurfelWeights& weights, BlockSystem& system,
                            BlockSystem& coupling) {
  const double slack2 = weights.slack_m * weights.slack_m;
  SurfelSums sums;
  sums.matches = matches.size();
  for (const SurfelMatch& m : matches) {
    const Surfel &a = surfels[m.first], &b = surfels[m.second];
    const PairResidual r = surfel_residual(frame, a, b);
    const double layers = static_cast<double>(a.variance_m2) + static_cast<double>(b.variance_m2);
    const double variance = weights.sigma_m * weights.sigma_m + weights.layer_share * layers;
    const double square = r.error() * r.error();
    const double scale2 = weights.cauchy * weights.cauchy * variance + slack2;
    const double weight = weights.share / ((variance + slack2) * (1 + square / scale2));
    system.add(r.first, weight);
    system.add(r.second, weight);
    coupling.add_coupling(r.first, r.second, weight);
    sums.weights += weight, sums.squares += weight * square;
    sums.inliers += square < 9 * variance;
    sums.information += kIndependentShare / weights.share * weight * r.normal * r.normal.transpose();
  }
  return sums;
}

void apply_correction(const ResidualFrame& frame, const Eigen::VectorXd& knots, int first, int last, PoseTrack& track) {
  for (int k = first; k <= last; ++k) {
    const SplineWeights w = frame.spline.weights(k * track.step_s);
    const Eigen::Vector3d p = track.position[k];
    Eigen::Vector3d move = Eigen::Vector3d::Zero(), turn = move;
    for (int j = 0; j < 4; ++j) {
      const auto x = knots.segment<6>(6 * (w.first + j));
      move += w.value[j] * (x.head<3>() + x.tail<3>().cross(p - frame.anchor[w.first + j]));
      turn += w.value[j] * x.tail<3>();
    }
    track.position[k] = p + move;
    track.rotation[k] = (exp_so3(turn) * track.rotation[k]).normalized();
  }
}

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
  stats.surfels = static_cast<int>(surfels.size());
  const InertialState before = state;
  const int threads = thread_count(options.threads);
  const int iterations = prior.first ? options.window.first_iterations : options.window.max_iterations;
  for (int it = 0; it < iterations; ++it) {
    // Later windows start from a trajectory that is right but for the newest second: they anneal over the second half.
    const double f =
        prior.first ? it / std::max(1.0, iterations - 5.0) : 0.5 + 0.5 * it / std::max(1.0, iterations - 2.0);
    const auto placed = place_surfels(surfels, track, track.position[first_sample], threads);
    MatchQuery query;
    query.radius_voxels = mix_log(options.match.first_radius_voxels, options.match.last_radius_voxels, f);
    query.normal_scale_m = options.match.normal_scale_m;
    query.min_gap_s = options.match.min_time_gap_s;
    const auto matches = mutual_matches(placed, options.surfels.voxel_size_m, query, threads);
    const double cauchy = mix_log(options.match.first_cauchy, options.match.last_cauchy, f);

    system.clear();
    frame.anchor = anchors_of(frame.spline, track);
    // A fixed number of partial sums: threads must not change the result.
    std::array<SurfelSums, kParts> sums_of;
    parallel_each(kParts, threads, [&](std::size_t part, int) {
      const std::size_t begin = matches.size() * part / kParts, end = matches.size() * (part + 1) / kParts;
      parts[part].clear();
      sums_of[part] = add_surfel_terms(frame, surfels, std::span(matches).subspan(begin, end - begin),
                                       {options.match.sigma_m, cauchy}, parts[part], parts[part]);
    });
    SurfelSums surfel_sums;
    for (std::size_t part = 0; part < kParts; ++part) system.add(parts[part]), surfel_sums.add(sums_of[part]);
    describe(surfel_sums, stats);
    const ImuSums sums = add_imu_terms(frame, imu, noise, state, bias_block, first_sample, last_sample, system);
    stats.gyro_rms = std::sqrt(sums.gyro / std::max(1, sums.count)) * noise.gyro_scale;
    stats.accel_rms = std::sqrt(sums.accel / std::max(1, sums.count)) * noise.accel_scale;
    add_start(frame, prior, stats.start_s, system);
    add_inertial_prior(prior, before, state, bias_block, extra_block, system);

    RAYFIELD_ASSIGN(const Eigen::VectorXd x, system.solve());
    apply_correction(frame, x.head(6 * frame.spline.knots()), first_sample, last_sample, track);
    state.gyro_bias += x.segment<3>(6 * bias_block);
    state.accel_bias += x.segment<3>(6 * bias_block + 3);
    const double length_of_gravity = state.gravity.norm();
    state.gravity.head<2>() += x.segment<2>(6 * extra_block);
    state.gravity.z() = std::sqrt(length_of_gravity * length_of_gravity - state.gravity.head<2>().squaredNorm());
    stats.iterations = it + 1;
    double largest = 0;
    for (int j = 0; j < frame.spline.knots(); ++j) largest = std::max(largest, x.segment<3>(6 * j).norm());
    if (f >= 1 && largest < options.window.converged_m) break;
  }
  RAYFIELD_ASSIGN(const std::vector<Eigen::MatrixXd> joint, system.marginals({bias_block}, 2));
  stats.covariance = joint[0].topLeftCorner<8, 8>();
  return stats;
}

}  // namespace rayfield::slam
