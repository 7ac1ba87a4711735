#include "sim/scan/beams.h"

#include <cmath>
#include <numbers>

namespace rayfield::sim {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

BeamPattern spinning_pattern(const SiteSpinning& spinning) {
  BeamPattern pattern;
  pattern.period_s = 1 / spinning.rate_hz;
  const double field = spinning.field_of_view_deg * kRadians;
  for (int i = 0; i < spinning.beams; ++i) {
    const double angle = -0.5 * field + field * i / (spinning.beams - 1);
    pattern.direction.push_back(Eigen::Vector3d(std::cos(angle), std::sin(angle), 0).cast<float>());
    pattern.time_offset_s.push_back(static_cast<float>(i * spinning.time_increment_s));
  }
  return pattern;
}

BeamPattern multi_beam_pattern(const SiteMultiBeam& multi) {
  BeamPattern pattern;
  pattern.period_s = 1 / multi.rate_hz;
  for (int step = 0; step < multi.azimuth_steps; ++step) {
    const double turn = static_cast<double>(step) / multi.azimuth_steps;
    const double azimuth = 2 * std::numbers::pi * turn;
    for (int beam = 0; beam < multi.beams; ++beam) {
      const double part = multi.beams > 1 ? static_cast<double>(beam) / (multi.beams - 1) : 0.5;
      const double elevation =
          kRadians * (multi.elevation_min_deg + part * (multi.elevation_max_deg - multi.elevation_min_deg));
      pattern.direction.push_back(Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                                  std::cos(elevation) * std::sin(azimuth), std::sin(elevation))
                                      .cast<float>());
      pattern.time_offset_s.push_back(static_cast<float>(turn * pattern.period_s));
    }
  }
  return pattern;
}

}  // namespace

BeamPattern beam_pattern(const Site& site) {
  return site.lidar.kind == LidarKind::spinning ? spinning_pattern(site.spinning) : multi_beam_pattern(site.multi_beam);
}

double spinner_angle(const SiteSpinning& spinning, double t) {
  constexpr double kWobbleRate = 2 * std::numbers::pi * 0.11;  // rad/s
  return 2 * std::numbers::pi * spinning.spin_rate_hz * t + spinning.spin_wobble_rad * std::sin(kWobbleRate * t);
}

}  // namespace rayfield::sim
