#include "libslam/surfels/pole_detection.h"

#include <gtest/gtest.h>

#include <random>

#include "libslam/surfels/surfel.h"

namespace rayfield::slam {
namespace {

const Eigen::Vector3d kSensor(0, 0, 1.6);

// A scan line up and down at the azimuth of (x, y), ranges with noise.
void add_line(double x, double y, double low, double high, double noise, std::mt19937& generator,
              std::vector<BodyPoint>& out) {
  std::normal_distribution<double> gauss(0, noise);
  for (double z = low; z < high; z += 0.035) {
    const Eigen::Vector3d beam = Eigen::Vector3d(x, y, z) - kSensor;
    const Eigen::Vector3d p = beam * (1 + gauss(generator) / beam.norm());
    out.push_back({0.1, p.cast<float>(), 0});
  }
}

PoseTrack still_track(const Eigen::Vector3d& position) {
  PoseTrack t;
  for (int k = 0; k <= 100; ++k)
    t.position.push_back(position), t.rotation.emplace_back(Eigen::Quaterniond::Identity());
  return t;
}

TEST(DetectPoles, SeesATrunkInAScanLineButNoWallGroundOrFoliage) {
  std::mt19937 generator(7);
  std::vector<BodyPoint> points;
  add_line(2.0, 0.4, 0.25, 0.9, 0.012, generator, points);                                      // trunk
  for (double y = -2; y < -1; y += 0.05) add_line(2.5, y, 0.2, 1.6, 0.012, generator, points);  // wall
  std::uniform_real_distribution<float> spread(-0.3f, 0.3f);
  for (int k = 0; k < 600; ++k) {
    const Eigen::Vector3f at(spread(generator), spread(generator), spread(generator));
    points.push_back({0.1, Eigen::Vector3f(2, 3, -0.2f) + at, 0});                                    // foliage
    points.push_back({0.1, Eigen::Vector3f(2 + 3 * at.x(), 4 * at.y(), -1.6f + 0.02f * at.z()), 0});  // ground
  }
  const auto poles = extract_features(points, BeamSource(), still_track(kSensor), SurfelOptions(), PoleOptions()).poles;
  ASSERT_GE(poles.size(), 2u);
  const Eigen::Vector3f towards = -Eigen::Vector3f(2.0f, 0.4f, 0).normalized();
  for (const Surfel& s : poles) {
    EXPECT_NEAR(s.center.x(), 2.0, 0.02);
    EXPECT_NEAR(s.center.y(), 0.4, 0.02);
    EXPECT_GT(s.normal.dot(towards), 0.999f);
  }
}

}  // namespace
}  // namespace rayfield::slam
