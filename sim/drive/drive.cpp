#include "rayfield/sim/drive.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include "rayfield/core/date.h"
#include "rayfield/sim/random.h"
#include "sim/drive/path.h"
#include "sim/drive/true_trajectory.h"
#include "sim/terrain/smooth_noise.h"
#include "sim/terrain/terrain.h"

namespace rayfield::sim {
namespace {

constexpr double kKnot = 0.1;                    // s between control points of the trajectory
constexpr double kStep = 0.01;                   // s, integration step of speed and suspension
constexpr int kStepsPerKnot = 10;                // kKnot / kStep
constexpr double kWheelBase = 1.7;               // m
constexpr double kTrack = 1.2;                   // m
constexpr double kBumpLattice = 0.5;             // m
constexpr double kPitchPerAcceleration = 0.012;  // rad per m/s²: nose dives when braking
constexpr double kRollPerAcceleration = 0.02;    // rad per m/s²: leans out of turns
constexpr double kEndPause = 2.0;                // s standing at the end
constexpr double kLongestDrive = 86400;          // s

// `date`: of a site that has been validated.
double unix_midnight(const std::string& date) {
  const std::chrono::sys_days days = parse_calendar_day(date).value();
  return static_cast<double>(std::chrono::duration_cast<std::chrono::seconds>(days.time_since_epoch()).count());
}

// A damped oscillator that follows `target`: x'' = ω²(target − x) − 2ζω·x'.
struct Spring {
  double position = 0, velocity = 0;
  void follow(double target, double omega, double damping) {
    velocity += kStep * (omega * omega * (target - position) - 2 * damping * omega * velocity);
    position += kStep * velocity;
  }
};

// Speed over ground and place on the path, stepped in time.
class SpeedModel {
 public:
  SpeedModel(const Path& path, const SiteVehicle& vehicle, const SiteDate& date)
      : path_(path), vehicle_(vehicle), date_(date), speed_(date.stationary_start_s > 0 ? 0 : date.speed_m_s) {}

  double place() const { return place_; }
  double speed() const { return speed_; }
  double acceleration() const { return acceleration_; }
  bool arrived() const { return path_.curve.end() - place_ < 0.02; }

  void step(double t) {
    acceleration_ = 0;
    if (t < date_.stationary_start_s || arrived()) {
      speed_ = t < date_.stationary_start_s ? 0 : speed_ * 0.9;
      return;
    }
    const double wanted =
        std::clamp((target() - speed_) / 0.5, -vehicle_.acceleration_m_s2, vehicle_.acceleration_m_s2);
    acceleration_ = wanted;
    speed_ = std::max(0.02, speed_ + kStep * acceleration_);
    place_ = std::min(path_.curve.end(), place_ + kStep * speed_);
  }

 private:
  const Path& path_;
  const SiteVehicle& vehicle_;
  const SiteDate& date_;
  std::size_t turn_ = 0;
  double place_ = 0, speed_ = 0, acceleration_ = 0;

  // Cruising speed with slow unevenness, bounded so that turns and the end are reached at their own speed.
  double target() {
    const double uneven = smooth_noise(date_.seed, Stream::speed, 0, place_ / 8);
    double speed = date_.speed_m_s * (1 + 0.04 * std::clamp(uneven, -2.0, 2.0));
    const double braking = 0.8 * vehicle_.acceleration_m_s2;
    const auto bound = [&](double distance, double then) {
      speed = std::min(speed, std::sqrt(then * then + 2 * braking * std::max(0.0, distance)));
    };
    while (turn_ < path_.turns.size() && place_ > path_.turns[turn_].to) ++turn_;
    if (turn_ < path_.turns.size()) bound(path_.turns[turn_].from - place_, vehicle_.turn_speed_m_s);
    bound(path_.curve.end() - place_, 0.02);
    return speed;
  }
};

// Height and attitude of the body over the ground.
class BodyModel {
 public:
  BodyModel(const World& world, const Path& path) : world_(world), path_(path) {}

  struct Attitude {
    double height, pitch, roll;
  };

  void step(double place, double speed, double acceleration, bool first) {
    const auto at = path_.curve.evaluate(place);
    const Eigen::Vector2d heading = at.first.normalized(), left(-heading.y(), heading.x());
    const double curvature =
        (at.first.x() * at.second.y() - at.first.y() * at.second.x()) / std::pow(at.first.norm(), 3);
    std::array<double, 4> wheel;  // front left, front right, rear left, rear right
    for (std::size_t i = 0; i < 4; ++i) {
      const double ahead = (i < 2 ? 0.5 : -0.5) * kWheelBase, side = (i % 2 == 0 ? 0.5 : -0.5) * kTrack;
      wheel[i] = world_.terrain().smooth_height(at.value + ahead * heading + side * left) +
                 world_.site().vehicle.bump_m *
                     smooth_noise(world_.date().seed, Stream::wheel_bump, i % 2, (place + ahead) / kBumpLattice);
    }
    const double height = 0.25 * (wheel[0] + wheel[1] + wheel[2] + wheel[3]);
    const double pitch =
        0.5 * (wheel[2] + wheel[3] - wheel[0] - wheel[1]) / kWheelBase - kPitchPerAcceleration * acceleration;
    const double roll =
        0.5 * (wheel[0] + wheel[2] - wheel[1] - wheel[3]) / kTrack + kRollPerAcceleration * curvature * speed * speed;
    if (first) height_.position = height, pitch_.position = pitch, roll_.position = roll;
    const SiteVehicle& vehicle = world_.site().vehicle;
    const double omega = 2 * std::numbers::pi * vehicle.suspension_frequency_hz;
    // Tyres and springs are stiffer for the mean height than for the attitude.
    height_.follow(height, 2 * omega, vehicle.suspension_damping);
    pitch_.follow(pitch, omega, vehicle.suspension_damping);
    roll_.follow(roll, omega, vehicle.suspension_damping);
  }
  Attitude attitude() const { return {height_.position, pitch_.position, roll_.position}; }

 private:
  const World& world_;
  const Path& path_;
  Spring height_, pitch_, roll_;
};

// One control point of the trajectory: the IMU's place and attitude.
TrueTrajectory::Spline::Vector control_point(const Path& path, double place, const BodyModel::Attitude& body,
                                             double last_yaw, const SiteVehicle& vehicle) {
  const auto at = path.curve.evaluate(place);
  double yaw = std::atan2(at.first.y(), at.first.x());
  yaw += 2 * std::numbers::pi * std::round((last_yaw - yaw) / (2 * std::numbers::pi));
  const Eigen::Quaterniond rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(body.pitch, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(body.roll, Eigen::Vector3d::UnitX());
  const Eigen::Vector3d imu =
      Eigen::Vector3d(at.value.x(), at.value.y(), body.height) + rotation * Eigen::Vector3d(0, 0, vehicle.imu_height_m);
  TrueTrajectory::Spline::Vector point;
  point << imu, yaw, body.pitch, body.roll;
  return point;
}

void add_vibration(TrueTrajectory::Spline::Vector& point, const SiteVehicle& vehicle, std::uint64_t seed,
                   std::size_t knot) {
  CounterRandom random(seed, Stream::vibration, knot);
  point.head<3>() += vehicle.vibration_m * random.normal3();
  const Eigen::Vector3d shake = random.normal3();
  point.tail<3>() += vehicle.vibration_m * shake;  // about a lever of 1 m
}

double curve_length(const UniformSpline<2>& curve) {
  const double step = 0.05;
  double length = 0, s = 0.5 * step;
  while (s < curve.end()) {
    length += step * curve.evaluate(s).first.norm();
    s += step;
  }
  return length;
}

}  // namespace

double Drive::duration_s() const { return trajectory->duration(); }

std::vector<TimedPose> Drive::poses(double rate_hz) const {
  std::vector<TimedPose> result;
  const auto count = static_cast<std::size_t>(std::floor(duration_s() * rate_hz + 1e-9)) + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    result.push_back({start_time_s + t, trajectory->motion(t).enu_from_imu});
  }
  return result;
}

// Integrates speed and suspension along the path in steps of kStep, and every kKnot takes a control point of the
// trajectory; a spline through attracting points keeps poses, rates and accelerations consistent by construction.
Result<Drive> plan_drive(const World& world) {
  const Site& site = world.site();
  const SiteDate& date = world.date();
  Drive drive;
  drive.start_time_s = unix_midnight(date.date);
  drive.lanes = lane_order(site, date);
  const Path path = plan_path(world.block(), drive.lanes, site.vehicle.wander_m, date.seed);
  drive.path_m = curve_length(path.curve);

  SpeedModel speed(path, site.vehicle, date);
  BodyModel body(world, path);
  std::vector<TrueTrajectory::Spline::Vector> control;
  const Eigen::Vector2d start_direction = path.curve.evaluate(0).first;
  double yaw = std::atan2(start_direction.y(), start_direction.x());
  // The springs settle before the log starts, so that a stationary start is stationary.
  for (int i = 0; i < 500; ++i) body.step(0, speed.speed(), 0, i == 0);
  double arrived_at = -1;
  for (std::size_t knot = 0;; ++knot) {
    const double t = static_cast<double>(knot) * kKnot;
    control.push_back(control_point(path, speed.place(), body.attitude(), yaw, site.vehicle));
    yaw = control.back()[3];
    add_vibration(control.back(), site.vehicle, date.seed, knot);
    if (arrived_at < 0 && speed.arrived()) arrived_at = t;
    if (arrived_at >= 0 && t > arrived_at + kEndPause && control.size() > 6) break;
    if (t > kLongestDrive)
      return fail(ErrorCode::usage, "cannot plan drive", site.name + " " + date.label(),
                  fmt::format("it takes longer than {:.0f} hours", kLongestDrive / 3600),
                  "give a higher speed_m_s or fewer rows");
    for (int i = 0; i < kStepsPerKnot; ++i) {
      speed.step(t + i * kStep);
      body.step(speed.place(), speed.speed(), speed.acceleration(), false);
    }
  }
  // Two points before the first, so that the spline at time t follows the control point of time t.
  const TrueTrajectory::Spline::Vector lead = control[0] - control[1], origin = control[0];
  control.insert(control.begin(), {origin + 2 * lead, origin + lead});
  drive.trajectory = std::make_shared<const TrueTrajectory>(TrueTrajectory::Spline(0, kKnot, std::move(control)));
  return drive;
}

}  // namespace rayfield::sim
