#include "libslam/global_registration/registration_problem.h"

#include <algorithm>
#include <cmath>

#include "rayfield/core/median.h"
#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr int kImuGroup = 10;    // samples of one IMU residual: 0.1 s
constexpr double kFixed = 1e14;  // information that holds an unknown
constexpr double kGauge = 1e-3;  // weak prior of every knot, 1/m² and 1/rad²: holds the gauge without bending the drive
constexpr double kMisfitSeconds = 5;  // over which IMU and trajectory are compared
constexpr double kTurn = 0.3;         // rad in that time: a headland turn
constexpr int kDirectBlocks = 400;    // larger systems are solved iteratively
constexpr std::size_t kParts = 4;     // partial sums; their number is fixed so that threads do not change the result
// Prior standard deviations of what the rig file may ask to be estimated: lidar (s), spinner (rad).
const Eigen::Vector2d kOffsetSigma(0.05, 0.05);

// The largest move of an anchor after the best common yaw and translation (to first order) are taken out.
double largest_move(const std::vector<Eigen::Vector3d>& anchors, const Eigen::VectorXd& x) {
  const double n = static_cast<double>(anchors.size());
  Eigen::Vector3d center = Eigen::Vector3d::Zero(), mean = center;
  for (std::size_t j = 0; j < anchors.size(); ++j)
    center += anchors[j] / n, mean += x.segment<3>(6 * static_cast<Eigen::Index>(j)) / n;
  double turned = 0, spread = 1e-12;
  for (std::size_t j = 0; j < anchors.size(); ++j) {
    const Eigen::Vector2d p = (anchors[j] - center).head<2>(), d = x.segment<2>(6 * static_cast<Eigen::Index>(j));
    turned += p.x() * d.y() - p.y() * d.x(), spread += p.squaredNorm();
  }
  const Eigen::Vector3d yaw(0, 0, turned / spread);
  double largest = 0;
  for (std::size_t j = 0; j < anchors.size(); ++j) {
    const Eigen::Vector3d d = x.segment<3>(6 * static_cast<Eigen::Index>(j));
    largest = std::max(largest, (d - mean - yaw.cross(anchors[j] - center)).norm());
  }
  return largest;
}

}  // namespace

RegistrationProblem::RegistrationProblem(OdometryResult& odometry, const ImuGrid& imu,
                                         std::span<const GpsPosition> fixes, const Rig& rig, const SlamOptions& options,
                                         double knot_step_s, const RegistrationUnknowns& unknowns)
    : odometry_(odometry),
      imu_(imu),
      fixes_(fixes),
      rig_(rig),
      options_(options),
      knot_step_s_(knot_step_s),
      unknowns_(unknowns),
      sums_{BlockSystem(0, BlockSystem::Storage::sparse), BlockSystem(0, BlockSystem::Storage::sparse), {}, {}} {
  frame_.track = &odometry.track;
  const double length = odometry.track.end_s();
  frame_.spline.spans = std::max(1, static_cast<int>(std::lround(length / knot_step_s)));
  frame_.spline.step_s = length / frame_.spline.spans;
  bias_nodes_ = 1 + std::max(1, static_cast<int>(std::lround(length / options.global.bias_step_s)));
  first_bias_block_ = frame_.spline.knots();
  frame_.extra_block = first_bias_block_ + bias_nodes_;
  // Residuals without time and angle offsets are cheaper.
  surfel_frame_ = frame_;
  if (!rig.estimate_lidar_offset && !rig.estimate_spinner_offset) surfel_frame_.extra_block = -1;
  set_spinner(rig, surfel_frame_);
  gravity_ = Eigen::Vector3d(0, 0, odometry.inertial.front().state.gravity.norm());
  for (int k = 0; k < bias_nodes_; ++k) {
    const double time = k * length / (bias_nodes_ - 1);
    std::size_t nearest = 0;
    for (std::size_t n = 0; n < odometry.inertial.size(); ++n)
      if (std::abs(odometry.inertial[n].time_s - time) < std::abs(odometry.inertial[nearest].time_s - time))
        nearest = n;
    gyro_bias_.push_back(odometry.inertial[nearest].state.gyro_bias);
    accel_bias_.push_back(odometry.inertial[nearest].state.accel_bias);
  }
  const BlockSystem empty(frame_.extra_block + 1, BlockSystem::Storage::sparse);
  sums_ = {empty, empty, {}, {}};
  parts_.assign(kParts, sums_);
}

BiasWeights RegistrationProblem::bias_weights(double time_s) const {
  const double u = std::clamp(time_s / odometry_.track.end_s(), 0.0, 1.0) * (bias_nodes_ - 1);
  const int i = std::min(static_cast<int>(u), bias_nodes_ - 2);
  return {{first_bias_block_ + i, first_bias_block_ + i + 1}, {1 - (u - i), u - i}};
}

InertialState RegistrationProblem::inertial_at(const BiasWeights& w) const {
  InertialState s;
  s.gravity = gravity_;
  for (int j = 0; j < 2; ++j) {
    s.gyro_bias += w.weights[j] * gyro_bias_[w.blocks[j] - first_bias_block_];
    s.accel_bias += w.weights[j] * accel_bias_[w.blocks[j] - first_bias_block_];
  }
  return s;
}

void RegistrationProblem::add_inertial(int first_group, int last_group, BlockSystem& system,
                                       Eigen::Vector2d& squares) const {
  const double dt = frame_.track->step_s, duration = kImuGroup * dt;
  const double gyro_weight = 1 / odometry_.noise.gyro_variance(duration);
  const double accel_weight = 1 / odometry_.noise.accel_variance(duration);
  for (int group = first_group; group < last_group; ++group) {
    const int first = 1 + group * kImuGroup;
    const BiasWeights bias = bias_weights((first + 0.5 * kImuGroup) * dt);
    const InertialState state = inertial_at(bias);
    const auto g = gyro_residual(frame_, bias, state, imu_.gyro(), first, kImuGroup);
    const auto a = accel_residual(frame_, bias, state, imu_.accel(), first, kImuGroup);
    system.add(g, gyro_weight);
    system.add(a, accel_weight);
    squares += Eigen::Vector2d(g.error.squaredNorm(), a.error.squaredNorm());
  }
}

// Robust weights (Cauchy) are scaled by the median residual, so that fixes which are all off by the same bias are not
// all outliers.
void RegistrationProblem::add_gps(double slack, BlockSystem& system, RegistrationStats& stats) const {
  std::vector<double> residual;
  std::vector<LinearResidual<3>> rows;
  std::vector<const GpsPosition*> used;
  for (const GpsPosition& fix : fixes_) {
    const double time = fix.time_s;
    if (time < 0 || time > frame_.track->end_s()) continue;
    rows.push_back(gps_residual(frame_, time, rig_.imu_from_gps_m, fix.enu));
    residual.push_back(rows.back().error.head<2>().norm());
    used.push_back(&fix);
  }
  if (rows.size() < 2) return;
  const double median = median_of(residual);
  const double interval = (used.back()->time_s - used.front()->time_s) / static_cast<double>(used.size() - 1);
  // A receiver's error wanders: fixes within its correlation time carry one piece of information together.
  const double together = std::max(1.0, 2 * options_.gps.correlation_time_s / std::max(interval, 1e-3));
  double weight_sum = 0, square_sum = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double scale = slack * 1.5 * std::max(median, used[k]->sigma_horizontal_m);
    const double robust = 1 / (1 + residual[k] * residual[k] / (scale * scale));
    const double inflate = std::max(1.0, median / (1.18 * used[k]->sigma_horizontal_m));
    const double horizontal = 1 / (inflate * used[k]->sigma_horizontal_m), vertical = 1 / used[k]->sigma_vertical_m;
    LinearResidual<3>& r = rows[k];
    const Eigen::Vector3d root(horizontal, horizontal, vertical);
    r.error = root.cwiseProduct(r.error);
    for (int b = 0; b < r.blocks; ++b) r.jacobian[b] = root.asDiagonal() * r.jacobian[b];
    system.add(r, robust / together);
    weight_sum += robust, square_sum += robust * residual[k] * residual[k];
  }
  stats.gps_m = {residual.size(), std::sqrt(square_sum / weight_sum)};
}

void RegistrationProblem::add_priors(bool use_gps, BlockSystem& system) const {
  for (int k = 0; k < frame_.spline.knots(); ++k)
    system.add_prior(k, Vector6d::Zero(), Vector6d::Constant(use_gps ? 1e-3 * kGauge : kGauge));
  Vector6d bias;
  bias << Eigen::Vector3d::Constant(1 / (0.05 * 0.05)), Eigen::Vector3d::Constant(1 / (0.5 * 0.5));
  Vector6d offset;
  offset << -gyro_bias_[0], -accel_bias_[0];
  system.add_prior(first_bias_block_, offset, bias);
  // Random walk between bias nodes.
  const double step = odometry_.track.end_s() / (bias_nodes_ - 1);
  const double root_gyro = 1 / (rig_.imu.gyro_bias_rad_s2_sqrt_hz * std::sqrt(step));
  const double root_accel = 1 / (rig_.imu.accel_bias_m_s3_sqrt_hz * std::sqrt(step));
  Vector6d root;
  root << Eigen::Vector3d::Constant(root_gyro), Eigen::Vector3d::Constant(root_accel);
  for (int k = 0; k + 1 < bias_nodes_; ++k) {
    LinearResidual<6> r;
    Vector6d change;
    change << gyro_bias_[k + 1] - gyro_bias_[k], accel_bias_[k + 1] - accel_bias_[k];
    r.error = root.cwiseProduct(change);
    r.at(first_bias_block_ + k).diagonal() = -root;
    r.at(first_bias_block_ + k + 1).diagonal() = root;
    system.add(r, 1);
  }
  Vector6d extra = Vector6d::Constant(kFixed), extra_offset = Vector6d::Zero();
  const bool free[2] = {rig_.estimate_lidar_offset, rig_.spinner && rig_.estimate_spinner_offset};
  for (int k = 0; k < 2; ++k) {
    if (!free[k]) continue;
    extra[kLidarOffset + k] = 1 / (kOffsetSigma[k] * kOffsetSigma[k]);
    extra_offset[kLidarOffset + k] = -unknowns_.offsets[k];
  }
  const double depth_sigma = options_.poles.depth_sigma_m;
  extra[kPoleDepth] = 1 / (depth_sigma * depth_sigma);
  extra_offset[kPoleDepth] = options_.poles.depth_m - unknowns_.pole_depth_m;
  system.add_prior(frame_.extra_block, extra_offset, extra);
}

void RegistrationProblem::begin(const RegistrationWeights& weights) {
  weights_ = weights;
  frame_.anchor = surfel_frame_.anchor = anchors_of(frame_.spline, odometry_.track);
  const int groups = (frame_.track->size() - 2) / kImuGroup;
  parallel_each(kParts, thread_count(options_.threads), [&](std::size_t part, int) {
    const int n = static_cast<int>(kParts), p = static_cast<int>(part);
    Sums& sums = parts_[part];
    sums.chain.clear(), sums.coupling.clear();
    sums.near = sums.revisits = sums.poles = {}, sums.squares.setZero();
    add_inertial(groups * p / n, groups * (p + 1) / n, sums.chain, sums.squares);
  });
}

void RegistrationProblem::add_surfels(std::span<const Surfel> surfels, std::span<const SurfelMatch> near,
                                      std::span<const SurfelMatch> revisits) {
  const auto slice = [](auto all, std::size_t part) {
    const std::size_t begin = all.size() * part / kParts, end = all.size() * (part + 1) / kParts;
    return all.subspan(begin, end - begin);
  };
  parallel_each(kParts, thread_count(options_.threads), [&](std::size_t part, int) {
    Sums& sums = parts_[part];
    const double cauchy = options_.match.last_cauchy;
    SurfelWeights weights = weights_.cautious
                                ? SurfelWeights{options_.match.sigma_m, cauchy, 0.0, 1.0, kIndependentShare}
                                : SurfelWeights{options_.global.sigma_m, cauchy, 0.0, options_.global.layer_share, 1.0};
    sums.near.add(add_surfel_terms(surfel_frame_, surfels, slice(near, part), weights, sums.chain, sums.chain));
    weights.slack_m = weights_.slack_m;
    sums.revisits.add(
        add_surfel_terms(surfel_frame_, surfels, slice(revisits, part), weights, sums.chain, sums.coupling));
  });
}

// Ties the observations of every pole slice in pairs: eliminating the position of a slice of N observations with the
// variance σ² each leaves Σ_{i<j} |q_i − q_j|²/(N·σ²).
void RegistrationProblem::add_poles(const PoleQuery& query) {
  const PoleOptions& options = options_.poles;
  const PoseTrack& track = odometry_.track;
  const SurfelOffsets offsets = surfel_offsets();
  std::vector<Surfel> detections = odometry_.poles;
  for (Surfel& s : detections) apply_offsets(offsets, track.end_s(), s);
  const double depth = unknowns_.pole_depth_m;
  const std::vector<PoleObservation> observations = gather_observations(detections, track, depth, options);
  ResidualFrame frame = surfel_frame_;
  frame.extra_block = frame_.extra_block;
  const double slack2 = weights_.slack_m * weights_.slack_m, cauchy2 = std::pow(options_.match.last_cauchy, 2);
  const double share = weights_.cautious ? kIndependentShare : options.weight;
  Sums& sums = parts_[0];
  for (const PolePair& pair : pair_observations(observations, track, depth, query, options)) {
    const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(pair.sides);
    const double variance[2] = {pair.variance_m2 + pair.thickness_variance_m2, pair.variance_m2};
    PairResidual axes[2];
    double distance2 = 0;  // in standard deviations
    for (int k = 0; k < 2; ++k) {
      axes[k] = pole_residual(frame, observations[pair.first], observations[pair.second], depth,
                              k == 0 ? pair.sides : across);
      distance2 += axes[k].error() * axes[k].error() / (cauchy2 * variance[k] + slack2);
    }
    for (int k = 0; k < 2; ++k) {
      const double weight = share / ((0.5 * pair.observations * variance[k] + slack2) * (1 + distance2));
      sums.chain.add(axes[k].first, weight);
      sums.chain.add(axes[k].second, weight);
      sums.coupling.add_coupling(axes[k].first, axes[k].second, weight);
      sums.poles.weights += 0.5 * weight, sums.poles.squares += weight * axes[k].error() * axes[k].error();
    }
    ++sums.poles.matches;
  }
}

void RegistrationProblem::end(RegistrationStats& stats) {
  sums_.chain.clear(), sums_.coupling.clear();
  sums_.near = sums_.revisits = sums_.poles = {}, sums_.squares.setZero();
  for (const Sums& part : parts_) {
    sums_.chain.add(part.chain), sums_.coupling.add(part.coupling);
    sums_.near.add(part.near), sums_.revisits.add(part.revisits), sums_.poles.add(part.poles);
    sums_.squares += part.squares;
  }
  if (weights_.gps_slack > 0) add_gps(weights_.gps_slack, sums_.chain, stats);
  add_priors(weights_.gps_slack > 0, sums_.chain);

  stats.near_surfels = {sums_.near.matches, sums_.near.rms_m()};
  stats.revisit_surfels = {sums_.revisits.matches, sums_.revisits.rms_m()};
  stats.poles = {sums_.poles.matches, sums_.poles.rms_m()}, stats.pole_depth_m = unknowns_.pole_depth_m;
  const int groups = (frame_.track->size() - 2) / kImuGroup;
  const std::uint64_t count = static_cast<std::uint64_t>(groups);
  stats.gyro_rad_s = {count, std::sqrt(sums_.squares[0] / std::max(1, 3 * groups))};
  stats.accel_m_s2 = {count, std::sqrt(sums_.squares[1] / std::max(1, 3 * groups))};
}

Result<double> RegistrationProblem::solve_and_apply() {
  if (sums_.chain.blocks() <= kDirectBlocks) sums_.chain.add(sums_.coupling);
  RAYFIELD_ASSIGN(const Eigen::VectorXd x,
                  sums_.chain.blocks() <= kDirectBlocks ? sums_.chain.solve() : sums_.chain.solve(sums_.coupling));
  const double largest = largest_move(frame_.anchor, x);
  apply_correction(frame_, x.head(6 * frame_.spline.knots()), 0, odometry_.track.size() - 1, odometry_.track);
  for (int k = 0; k < bias_nodes_; ++k) {
    gyro_bias_[k] += x.segment<3>(6 * (first_bias_block_ + k));
    accel_bias_[k] += x.segment<3>(6 * (first_bias_block_ + k) + 3);
  }
  unknowns_.offsets += x.segment<2>(6 * frame_.extra_block + kLidarOffset);
  unknowns_.pole_depth_m += x[6 * frame_.extra_block + kPoleDepth];
  for (InertialNode& node : odometry_.inertial) node.state = inertial_at(bias_weights(node.time_s));
  return largest;
}

SurfelOffsets RegistrationProblem::surfel_offsets() const {
  return {{unknowns_.offsets[0], unknowns_.offsets[1]}, surfel_frame_.spin_axis, surfel_frame_.spin_origin};
}

// Mean residuals of gyroscope and accelerometer over sections of five seconds, in standard deviations. Turns are left
// out: the scale error of the gyroscope, which the rig file does not state, dominates there.
void RegistrationProblem::measure_imu_misfit(RegistrationStats& stats) const {
  const double dt = frame_.track->step_s, duration = kImuGroup * dt;
  const int groups = (frame_.track->size() - 2) / kImuGroup;
  const int together = std::max(1, static_cast<int>(std::lround(kMisfitSeconds / duration)));
  const double gyro_weight = together / odometry_.noise.gyro_variance(duration);
  const double accel_weight = together / odometry_.noise.accel_variance(duration);
  stats.imu_misfit = 0;
  for (int begin = 0; begin + together <= groups; begin += std::max(1, together / 2)) {
    const Eigen::Quaterniond &r0 = frame_.track->rotation[1 + begin * kImuGroup],
                             &r1 = frame_.track->rotation[1 + (begin + together) * kImuGroup];
    if (r0.angularDistance(r1) > kTurn) continue;
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = gyro;
    for (int group = begin; group < begin + together; ++group) {
      const int first = 1 + group * kImuGroup;
      const BiasWeights bias = bias_weights((first + 0.5 * kImuGroup) * dt);
      const InertialState state = inertial_at(bias);
      gyro += gyro_residual(frame_, bias, state, imu_.gyro(), first, kImuGroup).error / together;
      accel += accel_residual(frame_, bias, state, imu_.accel(), first, kImuGroup).error / together;
    }
    const double misfit = std::sqrt((gyro.squaredNorm() * gyro_weight + accel.squaredNorm() * accel_weight) / 6);
    if (misfit > stats.imu_misfit) stats.imu_misfit = misfit, stats.imu_misfit_s = (begin + 0.5 * together) * duration;
  }
}

Result<void> RegistrationProblem::measure_uncertainty(RegistrationStats& stats) {
  const int knots = frame_.spline.knots();
  // The gauge (translation and yaw) is held at the middle of the drive: uncertainty grows away from it.
  Vector6d hold = Vector6d::Constant(1e8);
  hold[3] = hold[4] = 0;
  for (int k = knots / 2 - 1; k <= knots / 2 + 1; ++k)
    if (k >= 0 && k < knots) sums_.chain.add_prior(k, Vector6d::Zero(), hold);
  sums_.chain.add(sums_.coupling);
  std::vector<int> blocks;
  const int samples = std::min(knots, 60);
  for (int k = 0; k < samples; ++k) blocks.push_back(static_cast<int>((k + 0.5) * knots / samples));
  blocks.push_back(frame_.extra_block);
  RAYFIELD_ASSIGN(const std::vector<Eigen::MatrixXd> covariance, sums_.chain.marginals(blocks));
  stats.uncertainty.clear();
  for (int k = 0; k < samples; ++k) {
    const double time =
        std::clamp((blocks[static_cast<std::size_t>(k)] - 1) * frame_.spline.step_s, 0.0, odometry_.track.end_s());
    stats.uncertainty.push_back({time, covariance[static_cast<std::size_t>(k)]});
  }
  const Eigen::Vector2d variance = covariance.back().diagonal().segment<2>(kLidarOffset);
  const bool free[2] = {rig_.estimate_lidar_offset, rig_.spinner && rig_.estimate_spinner_offset};
  for (int k = 0; k < 2; ++k) {
    stats.offsets[k] = unknowns_.offsets[k];
    stats.offset_sigmas[k] = free[k] ? std::sqrt(std::max(variance[k], 0.0)) : 0;
  }
  return {};
}

}  // namespace rayfield::slam
