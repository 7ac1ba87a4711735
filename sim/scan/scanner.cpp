#include "sim/scan/scanner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim/drive/true_trajectory.h"
#include "sim/site/random.h"

namespace rayfield::sim {
namespace {

constexpr std::size_t kBeamsPerChunk = 20000;

// Share of light that a surface sends back at right angles.
double reflectance(Material material) {
  switch (material) {
    case Material::ground:
      return 0.35;
    case Material::grass:
      return 0.5;
    case Material::leaf:
      return 0.55;
    case Material::wood:
      return 0.35;
    case Material::post:
      return 0.45;
    case Material::wire:
      return 0.7;
    case Material::building:
      return 0.65;
  }
  return 0.5;
}

// Received strength on a scale to 255: Lambert's law softened, falling with range.
float received_intensity(const SceneHit& hit, double max_range, CounterRandom& random) {
  const double strength =
      255 * reflectance(hit.material) * (0.3 + 0.7 * hit.cos_incidence) * (1 - 0.6 * hit.range_m / max_range) +
      4 * random.normal();
  return static_cast<float>(std::clamp(std::round(strength), 1.0, 255.0));
}

}  // namespace

Result<Scanner> Scanner::create(const World& world, const Drive& drive) {
  RAYFIELD_ASSIGN(const MapFromEnu map, MapFromEnu::create(world.site(), site_reach_m(world)));
  Scanner scanner(world, drive, map);
  scanner.pattern_ = beam_pattern(world.site());
  scanner.rig_ = site_rig(world.site());
  scanner.imu_from_spinner_ = scanner.rig_.imu_from_spinner.rotation.toRotationMatrix();
  scanner.spinner_from_lidar_ = scanner.rig_.spinner_from_lidar.rotation.toRotationMatrix();
  const double last_offset = static_cast<double>(scanner.pattern_.time_offset_s.back());
  const double scans = std::floor((drive.duration_s() - last_offset) / scanner.pattern_.period_s + 1e-9);
  scanner.scan_count_ = scans < 0 ? 0 : static_cast<std::size_t>(scans) + 1;
  scanner.scans_per_chunk_ = std::max<std::size_t>(1, kBeamsPerChunk / scanner.pattern_.direction.size());
  return scanner;
}

Scanner::Shot Scanner::shoot(double t, const Eigen::Vector3d& direction) const {
  const TrueTrajectory::PoseMatrix pose = drive_.trajectory->pose(t);
  Shot shot;
  Eigen::Matrix3d enu_from_turned = pose.rotation * imu_from_spinner_;
  const Eigen::Vector3d spinner = pose.rotation * rig_.imu_from_spinner.translation + pose.translation;
  if (rig_.spinner) {
    const double angle = spinner_angle(world_.site().spinning, t);
    const double c = std::cos(angle), s = std::sin(angle);
    Eigen::Matrix3d turn;  // about the spinner's z axis
    turn << c, -s, 0, s, c, 0, 0, 0, 1;
    enu_from_turned = (enu_from_turned * turn).eval();
  }
  shot.origin = enu_from_turned * rig_.spinner_from_lidar.translation + spinner;
  shot.direction = (enu_from_turned * (spinner_from_lidar_ * direction)).normalized();
  return shot;
}

std::optional<SceneHit> Scanner::first_return(const Shot& shot, std::uint64_t beam) const {
  const SiteLidar& lidar = world_.site().lidar;
  std::optional<SceneHit> nearest = world_.cast(shot.origin, shot.direction, lidar.max_range_m);
  if (lidar.sub_rays <= 1 || lidar.divergence_mrad <= 0) return nearest;
  // The other sub-rays lie on rings that share the beam's cross-section evenly; the turn differs from beam to beam.
  const Eigen::Vector3d helper =
      std::abs(shot.direction.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d u = helper.cross(shot.direction).normalized(), v = shot.direction.cross(u);
  const double half_angle = 0.5e-3 * lidar.divergence_mrad;
  const double first = 2 * std::numbers::pi * CounterRandom(world_.date().seed, Stream::lidar, ~beam).uniform();
  for (int i = 1; i < lidar.sub_rays; ++i) {
    const double radius = half_angle * std::sqrt(static_cast<double>(i) / lidar.sub_rays);
    const double turn = first + 2.399963229728653 * i;  // the golden angle
    const Eigen::Vector3d direction =
        (shot.direction + radius * (std::cos(turn) * u + std::sin(turn) * v)).normalized();
    const auto hit = world_.cast(shot.origin, direction, lidar.max_range_m);
    if (hit && (!nearest || hit->range_m < nearest->range_m)) nearest = hit;
  }
  return nearest;
}

// One lidar message and its rays. Random numbers are drawn by the number of the beam, hits or not, so that no beam
// depends on another.
void Scanner::render_scan(std::size_t index, bool want_rays, Chunk& out) const {
  const SiteLidar& lidar = world_.site().lidar;
  const double start = static_cast<double>(index) * pattern_.period_s;
  LidarScan scan;
  scan.time_s = drive_.start_time_s + start - world_.date().lidar_time_error_s;
  const std::size_t beams = pattern_.direction.size();
  scan.direction = pattern_.direction;
  scan.time_offset_s = pattern_.time_offset_s;
  scan.range_m.reserve(beams), scan.intensity.reserve(beams);
  for (std::size_t i = 0; i < beams; ++i) {
    const std::uint64_t beam = index * beams + i;
    const double t = start + static_cast<double>(pattern_.time_offset_s[i]);
    const Shot shot = shoot(t, pattern_.direction[i].cast<double>());
    const std::optional<SceneHit> hit = first_return(shot, beam);
    float range = std::numeric_limits<float>::infinity(), intensity = 0;
    if (hit) {
      CounterRandom random(world_.date().seed, Stream::lidar, beam);
      range = static_cast<float>(hit->range_m + lidar.range_noise_m * random.normal());
      intensity = received_intensity(*hit, lidar.max_range_m, random);
      const bool dropped = random.uniform() < lidar.dropout_fraction;
      if (static_cast<double>(range) < lidar.min_range_m) range = -std::numeric_limits<float>::infinity();
      if (dropped) range = std::numeric_limits<float>::quiet_NaN();
      if (!std::isfinite(range)) intensity = 0;
    }
    scan.range_m.push_back(range), scan.intensity.push_back(intensity);
    ++out.counts.beams;
    const bool valid = std::isfinite(range);
    const bool free_sky = !hit && shot.direction.z() > 0;
    ++(valid ? out.counts.hits : free_sky ? out.counts.no_returns : out.counts.dropped);
    if (!want_rays || !(valid || free_sky)) continue;
    const double length = valid ? static_cast<double>(range) : lidar.max_range_m;
    out.rays.push(map_(shot.origin), map_(shot.origin + length * shot.direction), drive_.start_time_s + t,
                  static_cast<std::uint16_t>(intensity), valid);
  }
  ++out.counts.lidar_messages;
  out.scans.push_back(std::move(scan));
}

void Scanner::render(std::size_t chunk, bool want_rays, Chunk& out) const {
  out = Chunk();
  const std::size_t first = chunk * scans_per_chunk_, last = std::min(first + scans_per_chunk_, scan_count_);
  if (want_rays) out.rays.reserve((last - first) * beams_per_scan());
  for (std::size_t scan = first; scan < last; ++scan) render_scan(scan, want_rays, out);
}

}  // namespace rayfield::sim
