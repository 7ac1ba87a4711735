#include "libslam/surfels/range_resolution.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace rayfield::slam {
namespace {

const std::vector<double> kVoxels = {0.3, 0.6, 1.2};
constexpr double kHeight_m = 1.8, kSpeed_m_s = 1.5;

// 40 s straight ahead over level ground.
PoseTrack straight_drive() {
  PoseTrack track;
  for (int k = 0; k <= 4000; ++k)
    track.position.emplace_back(0.01 * k * kSpeed_m_s, 0, kHeight_m), track.rotation.emplace_back(1, 0, 0, 0);
  return track;
}

// Ground all round the vehicle, as a lidar that resolves `resolution_m` sees it with beams of `source`: each surfel
// stands too near by spot_shift_m, with noise of 2 mm in height.
SurfelFile ground(const BeamSource& source, double resolution_m) {
  std::mt19937 generator(7);
  std::normal_distribution<double> noise(0, 0.002);
  std::uniform_real_distribution<double> place(-7, 7);
  std::vector<Surfel> surfels;
  for (int k = 0; k < 12000; ++k) {
    Surfel s;
    s.time_s = 40.0 * k / 12000;
    s.level = 1;
    const Eigen::Vector3d truth(place(generator), place(generator) / 4, -kHeight_m), up = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d ray = (truth - source.origin).normalized();
    const double shift = spot_shift_m(source.spot_depth_m(truth, up), resolution_m);
    s.center = (truth - shift * ray + noise(generator) * up).cast<float>();
    s.normal = up.cast<float>();
    s.variance_m2 = 1e-5f;
    surfels.push_back(s);
  }
  SurfelFile file;
  EXPECT_TRUE(file.append(surfels));
  return file;
}

std::optional<RangeResolution> measured(const BeamSource& source, double resolution_m) {
  const auto result = measure_range_resolution(ground(source, resolution_m), straight_drive(), source, kVoxels);
  EXPECT_TRUE(result) << result.error().line();
  return result ? *result : std::nullopt;
}

TEST(MeasureRangeResolution, FindsWhatTheGroundWasSeenWith) {
  const BeamSource wide{{0, 0, 0.2}, {0.0136, 0.0119, {}}};
  for (const double truth : {0.06, 0.15, 0.25}) {
    const auto found = measured(wide, truth);
    ASSERT_TRUE(found) << truth;
    EXPECT_NEAR(found->value_m, truth, 0.06 * truth);  // steps of 3 %
    EXPECT_LT(found->sigma_m, 0.06 * truth);
    EXPECT_GT(found->pairs, 1000U);
  }
}

TEST(MeasureRangeResolution, SaysNothingWithoutDeepSpotsAndSparesAllWhereNothingCameEarly) {
  EXPECT_FALSE(measured({{0, 0, 0.2}, {0.002, 0.001, {}}}, 0.15));  // spots up to 0.05 m deep
  const auto found = measured({{0, 0, 0.2}, {0.0136, 0.0119, {}}}, 5);
  ASSERT_TRUE(found);
  EXPECT_GT(found->value_m, 0.4);  // the deepest spots
}

}  // namespace
}  // namespace rayfield::slam
