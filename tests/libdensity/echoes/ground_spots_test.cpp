#include "libdensity/echoes/ground_spots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rayfield::density {
namespace {

const LidarBeam kWide{0.0136, 0.0119, {}};
const tile::TileRef kTile{{0, 0}, 25};
constexpr double kSlopeEast = 0.08, kLidarAbove = 1.8;

double ground_at(double east, double north) { return 40 + kSlopeEast * east + 0.05 * std::sin(north / 4); }

GroundModel ground_model() {
  constexpr int kNodes = 51;
  Grid2<float> nodes(kTile.corner(), 0.5, kNodes, kNodes);
  for (int x = 0; x < kNodes; ++x)
    for (int y = 0; y < kNodes; ++y) nodes.at(x, y) = static_cast<float>(ground_at(0.5 * x, 0.5 * y));
  GroundModel ground(kTile.size_m);
  ground.set(kTile.index, std::move(nodes));
  return ground;
}

// A drive north through the tile at 2 m/s; rays to ground all round that a lidar of this resolution places too near.
struct Drive {
  std::shared_ptr<const SensorTrack> track;
  tile::SegmentBatch rays;
};
Drive drive_with(double resolution_m) {
  std::mt19937 generator(5);
  std::normal_distribution<double> noise(0, 0.01);
  std::uniform_real_distribution<double> time(0, 10), aside(-9, 9);
  std::vector<PathPoint> path;
  const auto lidar_at = [](double t) {
    const double east = 12, north = 2 + 2 * t;
    return Eigen::Vector3d(east, north, ground_at(east, north) + kLidarAbove);
  };
  for (double t = -1; t < 12; t += 0.1) path.push_back({t, lidar_at(t)});
  Drive drive{std::make_shared<const SensorTrack>(std::move(path)), {}};
  for (int i = 0; i < 200000; ++i) {
    const double t = time(generator);
    const Eigen::Vector3d from = lidar_at(t);
    const double east = from.x() + aside(generator), north = from.y() + aside(generator);
    const Eigen::Vector3d truth(east, north, ground_at(east, north)), ray = (truth - from).normalized();
    const Eigen::Vector3d normal = Eigen::Vector3d(-kSlopeEast, -0.05 / 4 * std::cos(north / 4), 1).normalized();
    const double cosine = std::abs(ray.dot(normal)), range_m = (truth - from).norm();
    const double depth_m = kWide.diameter_at(range_m) * std::sqrt(1 - cosine * cosine) / cosine;
    drive.rays.entry.push_back(from);
    drive.rays.exit.push_back(truth + (noise(generator) - spot_shift_m(depth_m, resolution_m)) * ray);
    drive.rays.time_s.push_back(t), drive.rays.intensity.push_back(100);
    drive.rays.flags.push_back(tile::kHit | tile::kStartsHere);
  }
  return drive;
}

TEST(GroundSpots, TellTheRangeResolution) {
  const GroundModel ground = ground_model();
  for (const double truth : {0.08, 0.15, 0.25}) {
    const Drive drive = drive_with(truth);
    GroundSpots spots(kWide, drive.track, ground, kTile);
    spots.add(drive.rays);
    const RangeResolution found = fit_range_resolution(spots.lifts());
    EXPECT_NEAR(found.value_m, truth, 0.01 + 0.05 * truth);
    EXPECT_LT(found.sigma_m, 0.2 * truth);
  }
}

TEST(GroundSpots, DoNotDependOnHowTheRaysAreDivided) {
  const GroundModel ground = ground_model();
  const Drive drive = drive_with(0.15);
  GroundSpots whole(kWide, drive.track, ground, kTile), even = whole, odd = whole;
  whole.add(drive.rays);
  tile::SegmentBatch halves[2];
  for (std::size_t i = 0; i < drive.rays.size(); ++i) {
    tile::SegmentBatch& half = halves[i % 2];
    half.entry.push_back(drive.rays.entry[i]), half.exit.push_back(drive.rays.exit[i]);
    half.time_s.push_back(drive.rays.time_s[i]), half.intensity.push_back(drive.rays.intensity[i]);
    half.flags.push_back(drive.rays.flags[i]);
  }
  even.add(halves[0]), odd.add(halves[1]);
  odd.merge(even);
  const std::vector<SpotLift> a = whole.lifts(), b = odd.lifts();
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 1000U);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].lift_m, b[i].lift_m);
}

TEST(GroundSpots, LookAtGroundThatIsKnownAndAtNothingElse) {
  Drive drive = drive_with(0.15);
  for (Eigen::Vector3d& end : drive.rays.exit) end.z() += 0.3;  // canopy
  const GroundModel ground = ground_model();
  GroundSpots above(kWide, drive.track, ground, kTile);
  above.add(drive.rays);
  EXPECT_TRUE(above.lifts().empty());
  const GroundModel none(kTile.size_m);
  GroundSpots unknown(kWide, drive.track, none, kTile);
  unknown.add(drive_with(0.15).rays);
  EXPECT_TRUE(unknown.lifts().empty());
}

}  // namespace
}  // namespace rayfield::density
