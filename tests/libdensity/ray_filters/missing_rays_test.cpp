#include "rayfield/density/missing_rays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayfield::density {
namespace {

constexpr double kPeriod = 1.0 / 28600;

class Rays : public RaySource {
 public:
  explicit Rays(RayBatch rays) : rays_(std::move(rays)) {}
  Result<std::size_t> read(RayBatch& batch, std::size_t max_rays) override {
    batch.clear();
    for (; batch.size() < max_rays && at_ < rays_.size(); ++at_)
      batch.push(rays_.origin[at_], rays_.end[at_], rays_.time_s[at_], rays_.intensity[at_], rays_.hit[at_] != 0);
    return batch.size();
  }
  Result<bool> rewind() override {
    at_ = 0;
    return true;
  }
  std::string name() const override { return "rays"; }

 private:
  RayBatch rays_;
  std::size_t at_ = 0;
};

/// A lidar that turns in a vertical plane over flat ground, 286 beams a turn; the plane turns slowly. Without walls the
/// rays within `blind` of the horizon find nothing; a cloud keeps the upper of these. `all`: keeps the lower, too. Rays
/// from `mast_low` to `mast_high` of elevation, ahead, meet the vehicle and are in no cloud.
RayBatch sweep(double blind_rad, bool all, double mast_low_rad = 0, double mast_high_rad = 0) {
  RayBatch out;
  for (int i = 0; i < 20000; ++i) {
    const double t = 1.6e9 + i * kPeriod, elevation = 2 * std::numbers::pi * i / 286.0, spin = 0.5 * i * kPeriod;
    const Eigen::Vector3d d(std::cos(elevation) * std::cos(spin), std::cos(elevation) * std::sin(spin),
                            std::sin(elevation));
    const Eigen::Vector3d o(1.2 * i * kPeriod, 0, 1.7);
    const bool hit = d.z() < -std::sin(blind_rad);
    if (!hit && d.z() < 0 && !all) continue;
    const double ahead = std::remainder(elevation, 2 * std::numbers::pi);
    if (ahead > mast_low_rad && ahead < mast_high_rad) continue;
    out.push(o, o + d * (hit ? 1.7 / -d.z() : 40.0), t, 9, hit);
  }
  return out;
}

RayBatch read_all(RaySource& source, std::size_t step) {
  RayBatch out, batch;
  while (source.read(batch, step).value_or(0) > 0)
    for (std::size_t i = 0; i < batch.size(); ++i)
      out.push(batch.origin[i], batch.end[i], batch.time_s[i], batch.intensity[i], batch.hit[i] != 0);
  return out;
}

TEST(MissingRays, DownwardRaysWithoutAReturnComeBackWhereTheyWere) {
  Rays kept(sweep(0.1, false));
  const RayBatch truth = sweep(0.1, true);
  auto source = MissingRaySource::create(kept, {});
  ASSERT_TRUE(source.has_value());
  const RayBatch restored = read_all(**source, 5000);
  ASSERT_GT((*source)->restored(), 200u);
  ASSERT_EQ(restored.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(restored.time_s[i], truth.time_s[i], 1e-6);
    EXPECT_LT((restored.end[i] - truth.end[i]).norm(), 1e-3) << i;
    EXPECT_EQ(restored.hit[i], truth.hit[i]);
  }
}

TEST(MissingRays, BatchSizesDoNotMatterAndRewindStartsAgain) {
  Rays kept(sweep(0.1, false));
  auto source = MissingRaySource::create(kept, {});
  ASSERT_TRUE(source.has_value());
  const RayBatch first = read_all(**source, 100000);
  ASSERT_TRUE((*source)->rewind().value_or(false));
  const RayBatch second = read_all(**source, 7);
  EXPECT_EQ(first.end, second.end);
}

TEST(MissingRays, ACompleteCloudIsPassedOnUnchanged) {
  const RayBatch truth = sweep(0.0, false);
  Rays complete(truth);
  auto source = MissingRaySource::create(complete, {});
  ASSERT_TRUE(source.has_value());
  EXPECT_EQ(read_all(**source, 1000).end, truth.end);
  EXPECT_EQ((*source)->restored(), 0u);
  EXPECT_TRUE((*source)->warnings().empty());
}

TEST(MissingRays, GapsBelowTheLowestElevationStayOpen) {
  const RayBatch gaps = sweep(0.5, false);  // a blind zone down to 29°
  Rays kept(gaps);
  auto source = MissingRaySource::create(kept, {});
  ASSERT_TRUE(source.has_value());
  EXPECT_EQ(read_all(**source, 1000).end, gaps.end);
  EXPECT_EQ((*source)->restored(), 0u);
}

TEST(MissingRays, WhatAPartOfTheVehicleHidesStaysOpen) {
  // Astern the gaps below the horizon are restored; ahead a mast hides from 10° below to 10° above, or the bonnet from
  // 3° to 20° below.
  const double degree = std::numbers::pi / 180;
  for (const auto& [low, high] : {std::pair(-10.0, 10.0), std::pair(-20.0, -3.0)}) {
    Rays kept(sweep(0.05, false, low * degree, high * degree));
    auto source = MissingRaySource::create(kept, {});
    ASSERT_TRUE(source.has_value());
    const RayBatch restored = read_all(**source, 5000);
    EXPECT_GT((*source)->restored(), 100u);
    for (std::size_t i = 0; i < restored.size(); ++i) {
      const Eigen::Vector3d d = (restored.end[i] - restored.origin[i]).normalized();
      const double spin = 0.5 * (restored.time_s[i] - 1.6e9);
      const double ahead = std::atan2(d.z(), d.x() * std::cos(spin) + d.y() * std::sin(spin));
      EXPECT_FALSE(ahead > (low + 0.1) * degree && ahead < (high - 0.1) * degree) << ahead / degree;
    }
  }
}

TEST(MissingRays, TimesThatDoNotTellBeamsApartAreReported) {
  RayBatch rays = sweep(0.1, false);
  for (double& t : rays.time_s) t = std::floor(t * 100) / 100;  // one stamp per turn
  Rays stamped(rays);
  auto source = MissingRaySource::create(stamped, {});
  ASSERT_TRUE(source.has_value());
  EXPECT_EQ(read_all(**source, 1000).end, rays.end);
  ASSERT_EQ((*source)->warnings().size(), 1u);
  ASSERT_TRUE((*source)->rewind().has_value());
  EXPECT_TRUE((*source)->warnings().empty());  // nothing is known of a stream that has not been read
}

// As `slam` writes them for lidars with several beams at a time: nothing is missing.
TEST(MissingRays, TimesThatDoNotTellBeamsApartDoNotMatterWhereDownwardMissesAreKept) {
  RayBatch rays = sweep(0.1, true);
  for (double& t : rays.time_s) t = std::floor(t * 100) / 100;
  Rays stamped(rays);
  auto source = MissingRaySource::create(stamped, {});
  ASSERT_TRUE(source.has_value());
  EXPECT_EQ(read_all(**source, 1000).end, rays.end);
  EXPECT_TRUE((*source)->warnings().empty());
}

TEST(MissingRays, EmptyStreamsAndBadOptionsAreHandled) {
  Rays none{RayBatch()};
  auto source = MissingRaySource::create(none, {});
  ASSERT_TRUE(source.has_value());
  EXPECT_EQ(read_all(**source, 10).size(), 0u);
  EXPECT_EQ(MissingRaySource::create(none, {0.5, 64, 2}).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace rayfield::density
