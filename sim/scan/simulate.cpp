#include "rayfield/sim/simulate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rayfield/core/parallel.h"
#include "sim/scan/scanner.h"
#include "sim/scan/sensors.h"

namespace rayfield::sim {
namespace {

// Hands out the messages of the small sensors up to a time, merged by stamp.
class SmallSensors {
 public:
  SmallSensors(const World& world, const Drive& drive, SensorSink& sink)
      : imu_(simulate_imu(world, drive)),
        spinner_(simulate_spinner(world, drive)),
        gps_(simulate_gps(world, drive)),
        sink_(sink) {}

  void emit_until(double time_s, SimulationSummary& counts) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    while (true) {
      const double imu = next_imu_ < imu_.size() ? imu_[next_imu_].time_s : kNever;
      const double spinner = next_spinner_ < spinner_.size() ? spinner_[next_spinner_].time_s : kNever;
      const double gps = next_gps_ < gps_.size() ? gps_[next_gps_].time_s : kNever;
      const double first = std::min({imu, spinner, gps});
      if (first == kNever || first > time_s) return;
      if (first == imu) {
        sink_.imu(imu_[next_imu_++]), ++counts.imu_samples;
      } else if (first == spinner) {
        sink_.spinner(spinner_[next_spinner_++]), ++counts.spinner_angles;
      } else {
        sink_.gps(gps_[next_gps_++]), ++counts.gps_fixes;
      }
    }
  }

 private:
  std::vector<ImuSample> imu_;
  std::vector<SpinnerAngle> spinner_;
  std::vector<GpsFix> gps_;
  SensorSink& sink_;
  std::size_t next_imu_ = 0, next_spinner_ = 0, next_gps_ = 0;
};

void add_counts(SimulationSummary& sum, const SimulationSummary& part) {
  sum.lidar_messages += part.lidar_messages;
  sum.beams += part.beams;
  sum.hits += part.hits;
  sum.no_returns += part.no_returns;
  sum.dropped += part.dropped;
}

tl::unexpected<Error> stopped(const World& world) {
  return fail(ErrorCode::interrupted, "simulation stopped", world.site().name + " " + world.date().label(),
              "asked to stop");
}

// What a data sheet says, no detection share and one angle, and the lidar's settings.
LidarBeam site_beam(const SiteLidar& lidar) {
  const double across = 1e-3 * lidar.divergence_mrad;
  const double along_z = lidar.divergence_z_mrad > 0 ? 1e-3 * lidar.divergence_z_mrad : across;
  return {.diameter_m = lidar.beam_diameter_m, .divergence_rad = std::sqrt(across * along_z), .returns = lidar.returns};
}

}  // namespace

Rig site_rig(const Site& site) {
  Rig rig;
  rig.lidar.min_range_m = site.lidar.min_range_m;
  rig.lidar.max_range_m = site.lidar.max_range_m;
  rig.lidar.no_return = NoReturn::infinity;
  if (site.lidar.wide()) rig.lidar.beam = site_beam(site.lidar);
  if (site.lidar.kind == LidarKind::spinning) {
    rig.spinner = Rig::Spinner();
    rig.imu_from_spinner = site.mount.imu_from_spinner;
    rig.spinner_from_lidar = site.mount.spinner_from_lidar;
  } else {
    rig.lidar.topic = "/lidar/points";
    rig.spinner_from_lidar = site.mount.imu_from_lidar;
  }
  if (site.gps.enabled) rig.gps = Rig::Gps();
  rig.imu_from_gps_m = site.mount.imu_from_gps_m;
  // The rig's own defaults stand in for a noise-free sensor, so that no estimator divides by zero.
  const auto stated = [](double& target, double density) {
    if (density > 0) target = density;
  };
  stated(rig.imu.gyro_noise_rad_s_sqrt_hz, site.imu.gyro_noise_rad_s_sqrt_hz);
  stated(rig.imu.accel_noise_m_s2_sqrt_hz, site.imu.accel_noise_m_s2_sqrt_hz);
  stated(rig.imu.gyro_bias_rad_s2_sqrt_hz, site.imu.gyro_bias_walk_rad_s2_sqrt_hz);
  stated(rig.imu.accel_bias_m_s3_sqrt_hz, site.imu.accel_bias_walk_m_s3_sqrt_hz);
  return rig;
}

// Chunks of lidar messages are rendered in parallel and consumed in order; the small sensors' messages, made
// beforehand, are merged in by their stamps.
Result<SimulationSummary> simulate(const World& world, const Drive& drive, SensorSink& sink, const RayCallback& rays,
                                   const SimulateOptions& options, Progress& progress) {
  RAYFIELD_ASSIGN(const Scanner scanner, Scanner::create(world, drive));
  const int threads = thread_count(options.threads);
  progress.stage("simulate " + world.date().label(), scanner.scan_count() * scanner.beams_per_scan(), "rays");
  SmallSensors small(world, drive, sink);
  SimulationSummary summary;
  std::vector<Scanner::Chunk> chunks(scanner.chunk_count());
  const bool want_rays = static_cast<bool>(rays);
  const auto produce = [&](std::size_t index, int) -> Result<void> {
    if (progress.cancelled()) return stopped(world);
    scanner.render(index, want_rays, chunks[index]);
    return {};
  };
  const auto consume = [&](std::size_t index) -> Result<void> {
    const Scanner::Chunk chunk = std::move(chunks[index]);
    chunks[index] = Scanner::Chunk();
    for (const LidarScan& scan : chunk.scans) {
      small.emit_until(scan.time_s, summary);
      sink.lidar(scan);
    }
    add_counts(summary, chunk.counts);
    progress.advance(chunk.counts.beams);
    if (want_rays) return rays(chunk.rays);
    return {};
  };
  RAYFIELD_CHECK(
      parallel_ordered(scanner.chunk_count(), threads, static_cast<std::size_t>(4 * threads), produce, consume));
  small.emit_until(std::numeric_limits<double>::max(), summary);
  return summary;
}

}  // namespace rayfield::sim
