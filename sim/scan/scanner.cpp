#include "sim/scan/scanner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "rayfield/sim/random.h"
#include "sim/drive/true_trajectory.h"
#include "sim/scan/disturbance.h"

namespace rayfield::sim {
namespace {

constexpr std::size_t kBeamsPerChunk = 20000;
constexpr double kWeakestGain = 0.01;

// Received strength on a scale to 255, falling with range.
float received_intensity(const Echo& echo, double max_range, CounterRandom& random) {
  const double strength = echo.strength * (1 - 0.6 * echo.range_m / max_range) + 4 * random.normal();
  return static_cast<float>(std::clamp(std::round(strength), 1.0, 255.0));
}

double gain_of(const SiteLidar& lidar, CounterRandom& random) {
  return lidar.echo_scatter == 0 ? 1 : std::max(kWeakestGain, 1 + lidar.echo_scatter * random.normal());
}

float measured_range(const Echo& echo, const SiteLidar& lidar, CounterRandom& random) {
  return static_cast<float>(echo.range_m + lidar.range_noise_m * random.normal());
}

// Where a beam has several echoes, what dust and drops send back, and false returns, are among them.
std::optional<Echo> nearest_of(const std::optional<Echo>& seen, const std::optional<Echo>& surface,
                               const SiteLidar& lidar, std::vector<Echo>& behind) {
  if (!seen || !surface || seen->range_m == surface->range_m) return seen;
  std::vector<Echo> all = {*seen, *surface};
  all.insert(all.end(), behind.begin(), behind.end());
  std::sort(all.begin(), all.end(), [](const Echo& a, const Echo& b) { return a.range_m < b.range_m; });
  behind.clear();
  double last_m = all.front().range_m;
  for (const Echo& echo : std::span(all).subspan(1)) {
    if (behind.size() + 1 == static_cast<std::size_t>(lidar.echoes)) break;
    if (echo.range_m > last_m + lidar.range_resolution_m) behind.push_back(echo), last_m = echo.range_m;
  }
  return all.front();
}

bool any(const SiteDisturbance& d) { return d.dust_share > 0 || d.rain_per_m > 0 || d.spurious_share > 0; }

}  // namespace

Result<Scanner> Scanner::create(const World& world, const Drive& drive) {
  RAYFIELD_ASSIGN(const MapFromEnu map, MapFromEnu::create(world.site(), site_reach_m(world)));
  Scanner scanner(world, drive, map);
  scanner.pattern_ = beam_pattern(world.site());
  const SiteLidar& lidar = world.site().lidar;
  if (lidar.wide()) scanner.wide_beam_.emplace(lidar, world.site().reflectance);
  scanner.rig_ = site_rig(world.site());
  scanner.imu_from_spinner_ = scanner.rig_.imu_from_spinner.rotation.toRotationMatrix();
  scanner.spinner_from_lidar_ = scanner.rig_.spinner_from_lidar.rotation.toRotationMatrix();
  const double last_offset = static_cast<double>(scanner.pattern_.time_offset_s.back());
  const double scans = std::floor((drive.duration_s() - last_offset) / scanner.pattern_.period_s + 1e-9);
  scanner.scan_count_ = scans < 0 ? 0 : static_cast<std::size_t>(scans) + 1;
  scanner.scans_per_chunk_ = std::max<std::size_t>(1, kBeamsPerChunk / scanner.pattern_.direction.size());
  return scanner;
}

Shot Scanner::shoot(double t, const Eigen::Vector3d& direction) const {
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
  shot.across = (enu_from_turned * spinner_from_lidar_.col(2)).cross(shot.direction);
  if (shot.across.norm() < 1e-6) shot.across = shot.direction.unitOrthogonal();  // along the lidar's z axis
  shot.across.normalize();
  shot.along_z = shot.direction.cross(shot.across);
  return shot;
}

std::optional<Echo> Scanner::look_along_line(const Shot& shot, double t, std::uint64_t beam) const {
  const Site& site = world_.site();
  const std::optional<SceneHit> hit = world_.cast(shot.origin, shot.direction, site.lidar.max_range_m, t);
  if (!hit) return std::nullopt;
  CounterRandom speckle(world_.date().seed, Stream::speckle, beam);
  const SubEcho met = sub_echo(site.reflectance, site.lidar.detection, *hit, gain_of(site.lidar, speckle));
  if (site.disturbance.lost_echo_share > 0) {
    const double chance = chance_of_loss(site.disturbance, met.energy, detectable_energy(site.lidar, hit->range_m));
    if (CounterRandom(world_.date().seed, Stream::disturbance, ~beam).uniform() < chance) return std::nullopt;
  }
  return Echo{met.range_m, met.energy, met.strength};
}

// The disc is turned at random from beam to beam, so that its pattern cannot line up with edges.
std::optional<Echo> Scanner::look_with_width(const Shot& shot, double t, std::uint64_t beam,
                                             WideBeam::Bundle& bundle) const {
  const Site& site = world_.site();
  CounterRandom random(world_.date().seed, Stream::lidar, ~beam);
  wide_beam_->aim(shot, 2 * std::numbers::pi * random.uniform(), bundle);
  world_.cast(bundle.rays, site.lidar.max_range_m, t, bundle.hits);
  CounterRandom loss(world_.date().seed, Stream::disturbance, ~beam);
  const auto lost = [&](const Echo& echo) {
    return loss.uniform() < chance_of_loss(site.disturbance, echo.energy, detectable_energy(site.lidar, echo.range_m));
  };
  CounterRandom speckle(world_.date().seed, Stream::speckle, beam);
  const auto gain = [&] { return gain_of(site.lidar, speckle); };
  return wide_beam_->receive(bundle.hits, gain, random.uniform() - 0.5, lost, &bundle.behind);
}

std::optional<Echo> Scanner::look(const Shot& shot, double t, std::uint64_t beam, WideBeam::Bundle& bundle) const {
  bundle.behind.clear();
  const std::optional<Echo> echo = wide_beam_ ? look_with_width(shot, t, beam, bundle) : look_along_line(shot, t, beam);
  if (!any(world_.site().disturbance)) return echo;
  CounterRandom random(world_.date().seed, Stream::disturbance, beam);
  const std::optional<Echo> seen = disturbed(world_.site(), echo, random);
  return world_.site().lidar.echoes > 1 ? nearest_of(seen, echo, world_.site().lidar, bundle.behind) : seen;
}

// One lidar message and its rays. Random numbers are drawn by the number of the beam, hits or not, so that no beam
// depends on another.
void Scanner::render_scan(std::size_t index, bool want_rays, WideBeam::Bundle& bundle, Chunk& out) const {
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
    const std::optional<Echo> hit = look(shot, t, beam, bundle);
    float range = std::numeric_limits<float>::infinity(), intensity = 0;
    if (hit) {
      CounterRandom random(world_.date().seed, Stream::lidar, beam);
      range = measured_range(*hit, lidar, random);
      intensity = received_intensity(*hit, lidar.max_range_m, random);
      const bool dropped = random.uniform() < lidar.dropout_fraction;
      if (static_cast<double>(range) < lidar.min_range_m) range = -std::numeric_limits<float>::infinity();
      if (dropped) range = std::numeric_limits<float>::quiet_NaN();
      if (!std::isfinite(range)) bundle.behind.clear(), intensity = 0;
      for (const Echo& later : bundle.behind) {
        const float later_m = measured_range(later, lidar, random);
        scan.later.push_back(
            {static_cast<std::uint32_t>(i), later_m, received_intensity(later, lidar.max_range_m, random)});
      }
    }
    scan.range_m.push_back(range), scan.intensity.push_back(intensity);
    ++out.counts.beams;
    const bool valid = std::isfinite(range);
    const bool kept_miss = !hit && (shot.direction.z() > 0 || lidar.keeps_downward_misses);
    ++(valid ? out.counts.hits : kept_miss ? out.counts.no_returns : out.counts.dropped);
    if (!want_rays || !(valid || kept_miss)) continue;
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
  WideBeam::Bundle bundle;
  for (std::size_t scan = first; scan < last; ++scan) render_scan(scan, want_rays, bundle, out);
}

}  // namespace rayfield::sim
