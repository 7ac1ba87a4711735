#include "libslam/odometry/odometry.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "libslam/odometry/initialization.h"
#include "libslam/odometry/motion_search.h"
#include "rayfield/core/parallel.h"

namespace rayfield::slam {
namespace {

constexpr double kGravity = 9.80665;
constexpr double kAccelBiasSigma = 0.1;   // m/s², before anything is known
constexpr double kReuse = 3;              // matches that share the error of a surfel
constexpr double kMaxInitialSpeed = 3.5;  // m/s, of a drive that begins in motion

}  // namespace

Odometry::Odometry(const Rig& rig, const SlamOptions& options, double epoch_s)
    : rig_(rig), options_(options), imu_(epoch_s, 0.01), out_{.surfels = SurfelFile(options.scratch_directory())} {
  if (rig.lidar.beam) out_.source.beam = *rig.lidar.beam;
  out_.epoch_s = epoch_s;
  out_.track.step_s = imu_.step_s();
  out_.noise.gyro_density = rig.imu.gyro_noise_rad_s_sqrt_hz;
  out_.noise.accel_density = rig.imu.accel_noise_m_s2_sqrt_hz;
}

void Odometry::add(const BodyScan& scan) {
  const double bin = options_.surfels.time_bin_s;
  for (std::size_t k = 0; k < scan.time_s.size(); ++k) {
    const double time = scan.time_s[k] - imu_.epoch_s();
    lidar_end_s_ = std::max(lidar_end_s_, time);
    if (!std::isfinite(scan.range_m[k]) || time < 0) continue;
    const std::int64_t index = static_cast<std::int64_t>(std::floor(time / bin)) - extracted_bins_;
    if (index < 0) continue;  // later than its bin
    if (index >= static_cast<std::int64_t>(pending_.size())) pending_.resize(static_cast<std::size_t>(index) + 1);
    out_.source.origin = scan.origin[k];
    const Eigen::Vector3d p = scan.origin[k] + static_cast<double>(scan.range_m[k]) * scan.direction[k];
    pending_[static_cast<std::size_t>(index)].push_back({time, p.cast<float>(), scan.spin_rate_rad_s[k]});
  }
}

void Odometry::add_fix(double time_s, const Eigen::Vector3d& enu) {
  if (!initialized_ && (first_fixes_.empty() || time_s > first_fixes_.back().first))
    first_fixes_.emplace_back(time_s, enu);
}

void Odometry::integrate_to(int last_sample) {
  PoseTrack& t = out_.track;
  const double dt = t.step_s;
  while (t.size() <= last_sample) {
    const int k = t.size() - 1;
    const Eigen::Vector3d w = 0.5 * (imu_.gyro()[k] + imu_.gyro()[k + 1]) - state_.gyro_bias;
    const Eigen::Vector3d a = t.rotation[k] * (imu_.accel()[k] - state_.accel_bias) - state_.gravity;
    const Eigen::Vector3d step = k == 0 ? Eigen::Vector3d(out_.initial_motion.velocity * dt + 0.5 * dt * dt * a)
                                        : Eigen::Vector3d(t.position[k] - t.position[k - 1] + dt * dt * a);
    t.position.push_back(t.position[k] + step);
    t.rotation.push_back((t.rotation[k] * exp_so3(dt * w)).normalized());
  }
}

Result<void> Odometry::extract_to(double time_s) {
  const double bin = options_.surfels.time_bin_s;
  while (!pending_.empty() && static_cast<double>(extracted_bins_ + 1) * bin <= time_s + 1e-9) {
    std::vector<BodyPoint>& points = pending_.front();
    const std::size_t limit = static_cast<std::size_t>(options_.max_points_per_bin);
    if (points.size() > limit) {  // every n-th, so that the choice is even over time
      const double stride = static_cast<double>(points.size()) / static_cast<double>(limit);
      for (std::size_t k = 0; k < limit; ++k)
        points[k] = points[static_cast<std::size_t>(static_cast<double>(k) * stride)];
      points.resize(limit);
    }
    const auto [surfels, poles] = extract_features(points, out_.source, out_.track, options_.surfels, options_.poles,
                                                   thread_count(options_.threads));
    RAYFIELD_CHECK(out_.surfels.append(surfels));
    out_.poles.insert(out_.poles.end(), poles.begin(), poles.end());
    newest_.insert(newest_.end(), surfels.begin(), surfels.end());
    newest_bins_.push_back({extracted_bins_, surfels.size()});
    pending_.erase(pending_.begin());
    ++extracted_bins_;
  }
  while (static_cast<double>(extracted_bins_ + 1) * bin <= time_s + 1e-9) ++extracted_bins_;  // no points at all
  return {};
}

// Solves one window and carries the knowledge of biases and gravity over to the next one.
Result<void> Odometry::solve(int first_sample, int last_sample, bool first) {
  const double dt = out_.track.step_s;
  // Windows never begin earlier than the one before.
  const auto first_bin = static_cast<std::int64_t>(first_sample * dt / options_.surfels.time_bin_s + 1e-9);
  std::size_t past = 0;
  for (; !newest_bins_.empty() && newest_bins_.front().index < first_bin; newest_bins_.pop_front())
    past += newest_bins_.front().count;
  newest_.erase(newest_.begin(), newest_.begin() + static_cast<std::ptrdiff_t>(past));
  WindowPrior prior;
  prior.first = first;
  prior.covariance = inertial_covariance_;
  RAYFIELD_ASSIGN(WindowStats stats, solve_window(out_.track, imu_, newest_, options_, out_.noise, prior, first_sample,
                                                  last_sample, state_));
  // Windows overlap: a datum is used length/advance times, so only that share of the information gained is kept, and
  // less still, because a surface that is matched with several bins has the same error in all of them.
  const double reuse = first ? 1.0 : kReuse * options_.window.length_s / options_.window.advance_s;
  const Matrix8d before = inertial_covariance_.inverse(), after = stats.covariance.inverse();
  inertial_covariance_ = (before + (after - before) / reuse).inverse();
  Eigen::Matrix<double, 8, 1> walk;
  walk << Eigen::Vector3d::Constant(rig_.imu.gyro_bias_rad_s2_sqrt_hz),
      Eigen::Vector3d::Constant(rig_.imu.accel_bias_m_s3_sqrt_hz),
      Eigen::Vector2d::Constant(kGravity * out_.noise.gyro_density *
                                out_.noise.gyro_scale);  // the trajectory's own tilt drifts
  inertial_covariance_.diagonal() += options_.window.advance_s * walk.cwiseProduct(walk);
  inertial_covariance_ = 0.5 * (inertial_covariance_ + inertial_covariance_.transpose()).eval();
  out_.windows.push_back(stats);
  out_.inertial.push_back({0.5 * (stats.start_s + stats.end_s), state_});
  return {};
}

// Initializes attitude, noise, biases and their covariance from the first window of data, and solves it.
Result<void> Odometry::initialize() {
  const int last = static_cast<int>(std::lround(options_.window.length_s / out_.track.step_s));
  const Initialization initial = find_initialization(imu_, last);
  out_.initial_motion.stationary_s = initial.stationary_s;
  // Data that are noisier than the rig file says get less weight; less noisy ones do not get more.
  const WhiteNoise white = measure_white_noise(imu_);
  out_.noise.gyro_scale = std::max(1.0, white.gyro_density / out_.noise.gyro_density);
  out_.noise.accel_scale = std::max(1.0, white.accel_density / out_.noise.accel_density);
  state_.gyro_bias = initial.gyro_bias;
  state_.gravity = Eigen::Vector3d(0, 0, kGravity);
  Eigen::Matrix<double, 8, 1> sigma;
  sigma << Eigen::Vector3d::Constant(initial.gyro_bias_sigma), Eigen::Vector3d::Constant(kAccelBiasSigma),
      Eigen::Vector2d::Constant(kGravity * initial.tilt_sigma_rad);
  inertial_covariance_ = sigma.cwiseProduct(sigma).asDiagonal();
  out_.track.rotation = {initial.level_from_imu};
  out_.track.position = {Eigen::Vector3d::Zero()};
  if (initial.stationary_s == 0) RAYFIELD_CHECK(initialize_in_motion(last));
  integrate_to(last);
  RAYFIELD_CHECK(extract_to(options_.window.length_s));
  RAYFIELD_CHECK(solve(0, last, true));
  done_s_ = options_.window.length_s;
  initialized_ = true;
  return {};
}

// Finds the motion over the first window and replaces the quadratic part of the integrated positions by it: tilt, bias
// and velocity, which are unknown so far, would make that part meaningless.
Result<void> Odometry::initialize_in_motion(int last_sample) {
  integrate_to(last_sample);
  PoseTrack& track = out_.track;
  std::vector<std::pair<double, Eigen::Vector3d>> integrated;
  for (int k = 0; k < track.size(); ++k) integrated.emplace_back(k * track.step_s, track.position[k]);
  const QuadraticMotion unknown = fit_quadratic(integrated);
  for (int k = 0; k < track.size(); ++k) track.position[k] -= quadratic_at(unknown, k * track.step_s);
  std::vector<BodyPoint> points;
  for (const auto& part : pending_) points.insert(points.end(), part.begin(), part.end());
  std::erase_if(first_fixes_, [&](const auto& f) { return f.first < 0 || f.first > track.end_s(); });
  std::optional<QuadraticMotion> gps;
  if (first_fixes_.size() >= 10 && first_fixes_.back().first - first_fixes_.front().first > 0.6 * track.end_s())
    gps = fit_quadratic(first_fixes_);
  const QuadraticMotion motion =
      search_motion(points, track, gps, rig_.imu_from_gps_m, kMaxInitialSpeed, thread_count(options_.threads));
  out_.initial_motion.velocity = motion.row(1).transpose();
  for (int k = 0; k < track.size(); ++k) track.position[k] += quadratic_at(motion, k * track.step_s);
  return {};
}

Result<void> Odometry::step(double window_end_s) {
  const double dt = out_.track.step_s;
  const int last = static_cast<int>(std::lround(window_end_s / dt));
  const int first = static_cast<int>(std::lround((window_end_s - options_.window.length_s) / dt));
  integrate_to(last);
  RAYFIELD_CHECK(extract_to(window_end_s));
  RAYFIELD_CHECK(solve(std::max(0, first), last, false));
  done_s_ = window_end_s;
  return {};
}

// What is left after the last whole step: one window that ends with the data.
Result<void> Odometry::last_step() {
  const double dt = out_.track.step_s;
  const int last = std::min(imu_.size() - 1, static_cast<int>(std::floor(lidar_end_s_ / dt)) + 1);
  const int first = last - static_cast<int>(std::lround(options_.window.length_s / dt));
  if (last < out_.track.size() + 2) return {};
  integrate_to(last);
  RAYFIELD_CHECK(extract_to((static_cast<double>(extracted_bins_ + static_cast<std::int64_t>(pending_.size()))) *
                            options_.surfels.time_bin_s));
  return solve(std::max(0, first), last, false);
}

Result<void> Odometry::advance(bool flush) {
  const double margin = 0.05;  // a scan ends a little after its stamp
  while (true) {
    const double next = initialized_ ? done_s_ + options_.window.advance_s : options_.window.length_s;
    if (imu_.end_s() < next + 0.02) return {};
    // Without lidar for long the IMU carries the trajectory on.
    if (lidar_end_s_ < next + margin && !flush && imu_.end_s() < next + 3.0) return {};
    if (flush && lidar_end_s_ < next - options_.window.advance_s) return {};
    RAYFIELD_CHECK(initialized_ ? step(next) : initialize());
  }
}

Result<OdometryResult> Odometry::finish() {
  RAYFIELD_CHECK(advance(true));
  if (initialized_) RAYFIELD_CHECK(last_step());
  if (!initialized_)
    return fail(ErrorCode::bad_input, "cannot reconstruct the drive", "log",
                fmt::format("only {:.1f} s of IMU and lidar data overlap, at least {:.1f} s are needed",
                            std::max(0.0, std::min(imu_.end_s(), lidar_end_s_)), options_.window.length_s));
  // The first window may have seen only the beginning of a longer time at rest.
  if (out_.initial_motion.stationary_s > 0)
    out_.initial_motion.stationary_s = find_initialization(imu_, imu_.size()).stationary_s;
  return std::move(out_);
}

}  // namespace rayfield::slam
