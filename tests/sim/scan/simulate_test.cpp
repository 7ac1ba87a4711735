#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "rayfield/core/map_frame.h"
#include "sim/drive/true_trajectory.h"
#include "sim/terrain/terrain.h"
#include "tests/sim/recorded_drive.h"
#include "tests/sim/without_errors.h"

namespace rayfield::sim {
namespace {

// Rays rebuilt from the messages with the rig, the encoder (interpolated) and the true poses, as an unwarping stage
// would do it.
RayBatch rays_from_messages(const RecordedDrive& record, const Site& site) {
  const Rig rig = site_rig(site);
  const TangentPlane plane({site.latitude_deg, site.longitude_deg, site.height_m});
  const MapFrame frame = take(MapFrame::create(site.crs_code()));
  const auto to_map = [&](const Eigen::Vector3d& p) { return frame.map_from_geodetic(plane.geodetic_from_enu(p)); };
  RayBatch rays;
  for (std::size_t k = 0; k + 2 < record.scans.size(); k += 50) {
    const LidarScan& scan = record.scans[k];
    for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
      const double t = 0.01 * static_cast<double>(k) + static_cast<double>(scan.time_offset_s[i]);
      Rigid3 spun;
      if (rig.spinner) {
        const double a = record.angles[k].angle_rad, b = record.angles[k + 1].angle_rad;
        const double angle =
            a + std::remainder(b - a, 2 * std::numbers::pi) * (t - 0.01 * static_cast<double>(k)) / 0.01;
        spun.rotation = Eigen::AngleAxisd(angle, rig.spinner->axis);
      }
      const Rigid3 enu_from_lidar =
          record.drive.trajectory->motion(t).enu_from_imu * rig.imu_from_spinner * spun * rig.spinner_from_lidar;
      const Eigen::Vector3d direction = enu_from_lidar.rotation * scan.direction[i].cast<double>();
      const double range = static_cast<double>(scan.range_m[i]);
      const bool hit = std::isfinite(range);
      if (!hit && !(std::isinf(range) && range > 0 && direction.z() > 0)) continue;
      const double length = hit ? range : rig.lidar.max_range_m;
      rays.push(to_map(enu_from_lidar.translation), to_map(enu_from_lidar.translation + length * direction),
                record.drive.start_time_s + t, 0, hit);
    }
  }
  return rays;
}

TEST(Simulate, RaysAreTheMessagesPlacedWithTheTruePoses) {
  Site site = small_site();
  site.spinning.encoder_noise_rad = 0;  // the rays know the true angle
  const RecordedDrive record(site);
  const RayBatch expected = rays_from_messages(record, site);
  ASSERT_GT(expected.size(), 5000U);
  std::size_t found = 0, at = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    while (at < record.rays.size() && record.rays.time_s[at] < expected.time_s[i] - 2e-6) ++at;
    ASSERT_LT(at, record.rays.size());
    EXPECT_NEAR(record.rays.time_s[at], expected.time_s[i], 2e-6);
    EXPECT_EQ(record.rays.hit[at], expected.hit[i]);
    EXPECT_NEAR((record.rays.origin[at] - expected.origin[i]).norm(), 0, 2e-4);
    EXPECT_NEAR((record.rays.end[at] - expected.end[i]).norm(), 0, 5e-4);
    ++found, ++at;
  }
  EXPECT_EQ(found, expected.size());
}

TEST(Simulate, LaterEchoesLeaveAllElseAsItIs) {
  for (const bool disturbed : {false, true}) {
    Site site = small_site();
    site.lidar.beam_diameter_m = 0.0136, site.lidar.divergence_mrad = 11.9;
    site.spinning.beams = 60;
    if (disturbed) site.disturbance.rain_per_m = 0.01;
    const RecordedDrive one(site);
    site.lidar.echoes = 3;
    const RecordedDrive three(site);
    EXPECT_EQ(three.rays.end.size(), one.rays.end.size());
    EXPECT_TRUE(three.rays.end == one.rays.end);
    EXPECT_TRUE(three.rays.intensity == one.rays.intensity);
    ASSERT_EQ(three.scans.size(), one.scans.size());
    std::size_t later = 0;
    for (std::size_t k = 0; k < one.scans.size(); ++k) {
      const LidarScan& scan = three.scans[k];
      EXPECT_TRUE(scan.intensity == one.scans[k].intensity);
      EXPECT_TRUE(one.scans[k].later.empty());
      later += scan.later.size();
      std::uint32_t last = 0;
      for (const LaterEcho& echo : scan.later) {
        EXPECT_GE(echo.point, last);
        EXPECT_GT(echo.range_m, scan.range_m[echo.point]);
        EXPECT_GT(echo.intensity, 0);
        last = echo.point;
      }
    }
    EXPECT_GT(later, three.summary.hits / 100);
  }
}

TEST(Simulate, ShotsWithoutAReturnBecomeUpwardRaysOfMaximumRange) {
  const RecordedDrive record(small_site());
  const double scale = take(MapFrame::create("EPSG:7854")).scale_factor(record.rays.origin[0]);
  std::uint64_t misses = 0;
  for (std::size_t i = 0; i < record.rays.size(); ++i) {
    const Eigen::Vector3d d = record.rays.end[i] - record.rays.origin[i];
    if (record.rays.hit[i] != 0) {
      EXPECT_GT(record.rays.intensity[i], 0);
      EXPECT_LT(d.norm(), 40.2);
      continue;
    }
    ++misses;
    EXPECT_GT(d.z(), -1e-3);
    EXPECT_NEAR(d.norm(), 40, 40 * std::abs(scale - 1) + 1e-3);
    EXPECT_EQ(record.rays.intensity[i], 0);
  }
  EXPECT_EQ(misses, record.summary.no_returns);
  EXPECT_EQ(record.rays.size(), record.summary.hits + record.summary.no_returns);
  EXPECT_EQ(record.summary.beams, record.summary.hits + record.summary.no_returns + record.summary.dropped);
}

TEST(Simulate, ASiteMayKeepDownwardShotsWithoutAReturn) {
  Site site = small_site();
  site.terrain.slope_percent = 15;
  const RecordedDrive dropped(site);
  site.lidar.keeps_downward_misses = true;
  const RecordedDrive kept(site);
  std::uint64_t downward = 0;
  for (std::size_t i = 0; i < kept.rays.size(); ++i)
    if (kept.rays.hit[i] == 0 && kept.rays.end[i].z() < kept.rays.origin[i].z()) ++downward;
  EXPECT_GT(downward, 100u);
  // Rays that are level to within the float of a direction count either way.
  EXPECT_NEAR(static_cast<double>(kept.rays.size()), static_cast<double>(dropped.rays.size() + downward), 5);
  EXPECT_EQ(kept.summary.hits, dropped.summary.hits);
}

TEST(Simulate, RangesAreAsNoisyAsStatedAndDropOutsAsFrequent) {
  Site site = small_site();
  site.lidar.range_noise_m = site.lidar.dropout_fraction = 0;
  const RecordedDrive exact(site);
  site.lidar.range_noise_m = 0.015;
  site.lidar.dropout_fraction = 0.01;
  const RecordedDrive noisy(site);
  double squares = 0, hits = 0, dropped = 0;
  for (std::size_t k = 0; k < exact.scans.size(); ++k)
    for (std::size_t i = 0; i < exact.scans[k].range_m.size(); ++i) {
      const double a = static_cast<double>(exact.scans[k].range_m[i]),
                   b = static_cast<double>(noisy.scans[k].range_m[i]);
      if (!std::isfinite(a)) {
        EXPECT_EQ(a, b);
        continue;
      }
      if (std::isnan(b)) {
        ++dropped;
      } else {
        squares += (a - b) * (a - b), ++hits;
      }
    }
  EXPECT_NEAR(std::sqrt(squares / hits), 0.015, 0.015 * 5 / std::sqrt(2 * hits));
  EXPECT_NEAR(dropped / (hits + dropped), 0.01, 5 * std::sqrt(0.0099 / (hits + dropped)));
}

// Rays of the same drive with and without: the ratio of their intensities scatters as stated, and not with the beam
// before.
TEST(Simulate, EchoesScatterFromBeamToBeamAsStated) {
  constexpr double kScatter = 0.2;
  Site site = small_site();
  site.lidar.echo_scatter = 0;
  const RecordedDrive even(site);
  site.lidar.echo_scatter = kScatter;
  const RecordedDrive uneven(site);
  double n = 0, sum = 0, squares = 0, products = 0, last = 0;
  for (std::size_t k = 0; k < even.scans.size(); ++k)
    for (std::size_t i = 0; i < even.scans[k].range_m.size(); ++i) {
      const double a = static_cast<double>(even.scans[k].intensity[i]),
                   b = static_cast<double>(uneven.scans[k].intensity[i]);
      if (!(a > 60 && a < 120) || !(b > 0)) continue;  // far from the ends of the scale; other noise is a tenth
      const double gain = b / a - 1;
      ++n, sum += gain, squares += gain * gain, products += gain * last, last = gain;
    }
  ASSERT_GT(n, 10000);
  EXPECT_NEAR(sum / n, 0, 5 * kScatter / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), kScatter, 0.02 * kScatter);
  EXPECT_NEAR(products / n, 0, 5 * kScatter * kScatter / std::sqrt(n));
}

TEST(Simulate, NoExactReturnLiesUnderTheTrueGround) {
  const Site site = without_errors(small_site());
  const RecordedDrive record(site);
  const MapFrame frame = take(MapFrame::create(site.crs_code()));
  const TangentPlane plane({site.latitude_deg, site.longitude_deg, site.height_m});
  int ground = 0;
  for (std::size_t i = 0; i < record.rays.size(); i += 7) {
    if (record.rays.hit[i] == 0) continue;
    const Eigen::Vector3d p = plane.enu_from_geodetic(frame.geodetic_from_map(record.rays.end[i]));
    const double above = p.z() - record.world.terrain().height(p.head<2>());
    EXPECT_GT(above, -2e-3);
    ground += above < 2e-3 ? 1 : 0;
  }
  EXPECT_GT(ground, 1000);
}

TEST(Simulate, OutputDoesNotDependOnTheNumberOfThreads) {
  const RecordedDrive one(small_site(), {.rays = true, .threads = 1}), four(small_site(), {.rays = true, .threads = 4});
  ASSERT_EQ(one.rays.size(), four.rays.size());
  EXPECT_EQ(one.rays.end, four.rays.end);
  EXPECT_EQ(one.rays.time_s, four.rays.time_s);
  EXPECT_EQ(one.rays.intensity, four.rays.intensity);
  ASSERT_EQ(one.scans.size(), four.scans.size());
  for (std::size_t k = 0; k < one.scans.size(); ++k) EXPECT_EQ(one.scans[k].intensity, four.scans[k].intensity);
}

TEST(Simulate, MultiBeamMessagesHoldOneRevolutionWithTimesPerPoint) {
  Site site = without_errors(small_site());
  site.lidar.kind = LidarKind::multi_beam;
  site.dates[0].lanes = {1};
  const RecordedDrive record(site);
  ASSERT_GT(record.scans.size(), 10U);
  const LidarScan& scan = record.scans[3];
  EXPECT_EQ(scan.range_m.size(), 16U * 720U);
  EXPECT_EQ(scan.time_offset_s.front(), 0);
  EXPECT_NEAR(scan.time_offset_s.back(), 0.1 * 719 / 720, 1e-6);
  EXPECT_NEAR(record.scans[4].time_s - scan.time_s, 0.1, 1e-6);
  EXPECT_NEAR(scan.direction[0].z(), std::sin(-15 * std::numbers::pi / 180), 1e-6);
  EXPECT_NEAR(scan.direction[15].z(), std::sin(15 * std::numbers::pi / 180), 1e-6);
  EXPECT_TRUE(record.angles.empty());
  EXPECT_GT(record.summary.hits, record.summary.beams / 4);
}

// A beam of 11.5 mrad is at least 8 mm wide where the wires hang; a ray meets 3 mm of wire, a beam of which a sliver is
// enough (k(0.03) = 0.89) 7 mm more.
TEST(Simulate, AWideBeamMeetsMoreWireThanANarrowOne) {
  Site site = without_errors(bare_site());
  site.structure.wire_heights_m = {2.6, 2.9};  // over the lidar: nothing else is up there
  const auto upward_hits = [&](double divergence) {
    Site copy = site;
    copy.lidar.divergence_mrad = divergence;
    copy.lidar.detection_share = 0.03;
    copy.dates[0].lanes = {0};
    const RecordedDrive record(copy);
    int count = 0;
    for (std::size_t i = 0; i < record.rays.size(); ++i)
      count += record.rays.hit[i] != 0 && record.rays.end[i].z() > record.rays.origin[i].z() + 0.3 ? 1 : 0;
    return count;
  };
  const int narrow = upward_hits(0), wide = upward_hits(11.5);
  EXPECT_GT(narrow, 100);
  EXPECT_GT(wide, 3 * narrow);
}

TEST(Simulate, AFailingReceiverStopsTheSimulationWithItsError) {
  const World world = make_world(small_site());
  const Drive drive = take(plan_drive(world));
  SensorSink sink;
  Progress progress;
  const auto result = simulate(
      world, drive, sink,
      [](const RayBatch&) -> Result<void> { return fail(ErrorCode::resources, "cannot write", "x", "disk full"); }, {2},
      progress);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::resources);
}

TEST(Simulate, TheRigDescribesTheSensors) {
  Site site = small_site_without_lidar();
  const Rig spinning = site_rig(site);
  EXPECT_TRUE(spinning.spinner);
  EXPECT_EQ(spinning.lidar.max_range_m, site.lidar.max_range_m);
  site.lidar.kind = LidarKind::multi_beam;
  site.gps.enabled = false;
  const Rig fixed = site_rig(site);
  EXPECT_FALSE(fixed.spinner);
  EXPECT_FALSE(fixed.gps);
  EXPECT_EQ(fixed.imu_from_spinner.translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(fixed.spinner_from_lidar.translation, site.mount.imu_from_lidar.translation);
  EXPECT_TRUE(RecordedDrive(site, {.rays = false}).fixes.empty());
}

}  // namespace
}  // namespace rayfield::sim
