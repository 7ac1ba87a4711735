#include "sim/scan/sensors.h"

#include <cmath>
#include <numbers>

#include "rayfield/core/map_frame.h"
#include "rayfield/sim/random.h"
#include "sim/drive/true_trajectory.h"
#include "sim/scan/beams.h"

namespace rayfield::sim {
namespace {

std::size_t sample_count(const Drive& drive, double rate_hz) {
  return static_cast<std::size_t>(std::floor(drive.duration_s() * rate_hz + 1e-9)) + 1;
}

bool inside(double t, double start, double duration) { return t >= start && t < start + duration; }

}  // namespace

std::vector<ImuSample> simulate_imu(const World& world, const Drive& drive) {
  const SiteImu& imu = world.site().imu;
  const SiteDate& date = world.date();
  const double scale = date.imu_noise_scale, root_rate = std::sqrt(imu.rate_hz);
  CounterRandom start(date.seed, Stream::imu_bias, 0);
  Eigen::Vector3d gyro_bias = scale * imu.gyro_bias_rad_s * start.normal3();
  Eigen::Vector3d accel_bias = scale * imu.accel_bias_m_s2 * start.normal3();
  std::vector<ImuSample> samples;
  const std::size_t count = sample_count(drive, imu.rate_hz);
  samples.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / imu.rate_hz;
    const Motion motion = drive.trajectory->motion(t);
    CounterRandom random(date.seed, Stream::imu, i);
    ImuSample sample;
    sample.time_s = drive.start_time_s + t;
    sample.angular_velocity_rad_s =
        motion.angular_velocity + gyro_bias + scale * imu.gyro_noise_rad_s_sqrt_hz * root_rate * random.normal3();
    sample.linear_acceleration_m_s2 =
        motion.specific_force() + accel_bias + scale * imu.accel_noise_m_s2_sqrt_hz * root_rate * random.normal3();
    samples.push_back(sample);
    gyro_bias += scale * imu.gyro_bias_walk_rad_s2_sqrt_hz / root_rate * random.normal3();
    accel_bias += scale * imu.accel_bias_walk_m_s3_sqrt_hz / root_rate * random.normal3();
  }
  return samples;
}

std::vector<SpinnerAngle> simulate_spinner(const World& world, const Drive& drive) {
  std::vector<SpinnerAngle> angles;
  if (world.site().lidar.kind != LidarKind::spinning) return angles;
  const SiteSpinning& spinning = world.site().spinning;
  const std::size_t count = sample_count(drive, spinning.encoder_rate_hz);
  angles.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / spinning.encoder_rate_hz;
    CounterRandom random(world.date().seed, Stream::encoder, i);
    const double angle = spinner_angle(spinning, t) - world.date().spinner_angle_error_rad +
                         spinning.encoder_noise_rad * random.normal();
    angles.push_back({drive.start_time_s + t, std::remainder(angle, 2 * std::numbers::pi)});
  }
  return angles;
}

// The bias runs on through outages, so that switching one on or off changes no other fix.
std::vector<GpsFix> simulate_gps(const World& world, const Drive& drive) {
  const Site& site = world.site();
  const SiteGps& gps = site.gps;
  const SiteDate& date = world.date();
  std::vector<GpsFix> fixes;
  if (!gps.enabled) return fixes;
  const TangentPlane plane({site.latitude_deg, site.longitude_deg, site.height_m});
  const Eigen::Vector3d bias_sigma =
      date.gps_bias_scale * Eigen::Vector3d(gps.bias_horizontal_m, gps.bias_horizontal_m, gps.bias_vertical_m);
  const Eigen::Vector3d noise_sigma(gps.noise_horizontal_m, gps.noise_horizontal_m, gps.noise_vertical_m);
  // First-order Gauss–Markov process, begun in its stationary state.
  const double keep = std::exp(-1 / (gps.rate_hz * gps.bias_time_constant_s));
  const double renew = std::sqrt(1 - keep * keep);
  Eigen::Vector3d bias =
      bias_sigma.cwiseProduct(CounterRandom(date.seed, Stream::gps_bias, ~std::uint64_t{0}).normal3());
  const std::size_t count = sample_count(drive, gps.rate_hz);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / gps.rate_hz;
    bias = keep * bias + renew * bias_sigma.cwiseProduct(CounterRandom(date.seed, Stream::gps_bias, i).normal3());
    bool silent = false;
    for (const GpsOutage& outage : date.gps_outages) silent = silent || inside(t, outage.start_s, outage.duration_s);
    if (silent) continue;
    Eigen::Vector3d p = drive.trajectory->motion(t).enu_from_imu * site.mount.imu_from_gps_m + bias +
                        noise_sigma.cwiseProduct(CounterRandom(date.seed, Stream::gps, i).normal3());
    for (const GpsJump& jump : date.gps_jumps)
      if (inside(t, jump.start_s, jump.duration_s)) p += Eigen::Vector3d(jump.east_m, jump.north_m, jump.up_m);
    const Eigen::Vector3d geodetic = plane.geodetic_from_enu(p);
    GpsFix fix;
    fix.time_s = drive.start_time_s + t - date.gps_time_error_s;
    fix.latitude_deg = geodetic.x(), fix.longitude_deg = geodetic.y(), fix.height_m = geodetic.z();
    fix.covariance_enu_m2.diagonal() << gps.reported_horizontal_m * gps.reported_horizontal_m,
        gps.reported_horizontal_m * gps.reported_horizontal_m, gps.reported_vertical_m * gps.reported_vertical_m;
    fix.covariance_type = 2;
    fixes.push_back(fix);
  }
  return fixes;
}

}  // namespace rayfield::sim
