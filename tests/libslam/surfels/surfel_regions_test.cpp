#include "libslam/surfels/surfel_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "libslam/surfels/surfel_match.h"
#include "tests/libslam/surfel_field.h"

namespace rayfield::slam {
namespace {

using testing::Field;

const std::vector<double> kVoxel = {0.3, 0.6, 1.2};

MatchQuery revisits() {
  MatchQuery q;
  q.radius_voxels = 1.2, q.max_radius_m = 1, q.min_gap_s = 10;
  return q;
}

// What two matched surfels are, whatever their indices.
using Pair = std::tuple<double, float, double, float>;
Pair pair_of(const Surfel& a, const Surfel& b) { return {a.time_s, a.center.x(), b.time_s, b.center.x()}; }

std::set<Pair> matches_of(std::span<const Surfel> surfels, const PoseTrack& track, const Eigen::Vector3d& origin,
                          std::span<const std::uint8_t> own = {}) {
  std::set<Pair> out;
  const auto placed = place_surfels(surfels, track, origin, 2);
  for (const SurfelMatch& m : mutual_matches(placed, kVoxel, revisits(), 2, own))
    EXPECT_TRUE(out.insert(pair_of(surfels[m.first], surfels[m.second])).second);
  return out;
}

std::set<Pair> matches_by_region(const SurfelRegions& regions, const PoseTrack& track) {
  std::set<Pair> out;
  SurfelRegion region;
  for (std::size_t k = 0; k < regions.count(); ++k) {
    EXPECT_TRUE(regions.load(k, region));
    for (const Pair& p : matches_of(region.surfels, track, region.center, region.own))
      EXPECT_TRUE(out.insert(p).second) << "two regions have the same match";
  }
  return out;
}

// Single precision with another origin moves ties: pairs that one has and the other has not, as a share.
double different(const std::set<Pair>& a, const std::set<Pair>& b) {
  std::vector<Pair> off;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(off));
  return static_cast<double>(off.size()) / static_cast<double>(std::max<std::size_t>(1, a.size()));
}

SurfelRegions by_region() { return {std::filesystem::temp_directory_path(), {.reach_m = {0.36, 0.72, 1.0}}}; }

TEST(SurfelRegions, OwnEverySurfelOnceAndInOrder) {
  const Field field(90000);
  SurfelRegions regions = by_region();
  ASSERT_TRUE(*regions.update_layout(field.file, field.track, {}, 2));
  EXPECT_GT(regions.count(), 15u);
  std::size_t own = 0;
  SurfelRegion region;
  for (std::size_t k = 0; k < regions.count(); ++k) {
    ASSERT_TRUE(regions.load(k, region));
    own += static_cast<std::size_t>(std::count(region.own.begin(), region.own.end(), 1));
    EXPECT_TRUE(std::is_sorted(region.surfels.begin(), region.surfels.end(),
                               [](const Surfel& a, const Surfel& b) { return a.time_s < b.time_s; }));
    EXPECT_LT(region.surfels.size(), field.surfels.size() / 4);
  }
  EXPECT_EQ(own, field.surfels.size());
}

TEST(SurfelRegions, HaveTheMatchesOfTheWholeDrive) {
  Field field(150000);
  const auto whole = matches_of(field.surfels, field.track, {10, 5, 0});
  ASSERT_GT(whole.size(), 5000u);
  SurfelRegions regions = by_region();
  ASSERT_TRUE(*regions.update_layout(field.file, field.track, {}, 2));
  EXPECT_LT(different(whole, matches_by_region(regions, field.track)), 2e-4);

  // Moved by less than the slack they stay where they are and still have all; moved by more they are laid out anew.
  for (int k = 0; k < field.track.size(); ++k)
    field.track.position[static_cast<std::size_t>(k)] +=
        0.3 * Eigen::Vector3d(std::sin(0.001 * k), std::cos(0.002 * k), 0);
  EXPECT_FALSE(*regions.update_layout(field.file, field.track, {}, 2));
  EXPECT_LT(different(matches_of(field.surfels, field.track, {10, 5, 0}), matches_by_region(regions, field.track)),
            2e-4);
  for (Eigen::Vector3d& p : field.track.position) p.x() += 0.5;
  EXPECT_TRUE(*regions.update_layout(field.file, field.track, {}, 2));
}

TEST(SurfelRegions, ApplyTheOffsetsOfTheSensors) {
  const Field field(3000);
  SurfelOffsets offsets;
  offsets.sensors = {0.02, 0.005};
  offsets.spin_axis = Eigen::Vector3d(0, 0, 1), offsets.spin_origin = Eigen::Vector3d(0.1, 0.2, 0.5);
  SurfelRegions regions = by_region();
  ASSERT_TRUE(*regions.update_layout(field.file, field.track, {}, 1));
  EXPECT_TRUE(*regions.update_layout(field.file, field.track, offsets, 1)) << "2 m at 30 m";
  SurfelRegion region;
  ASSERT_TRUE(regions.load(0, region));
  ASSERT_FALSE(region.surfels.empty());
  for (const Surfel& s : region.surfels) {
    const auto same = std::find_if(field.surfels.begin(), field.surfels.end(),
                                   [&](const Surfel& o) { return std::abs(o.time_s + 0.02 - s.time_s) < 1e-9; });
    ASSERT_NE(same, field.surfels.end());
    const Eigen::Quaterniond turn = exp_so3(Eigen::Vector3d(0, 0, 0.005 + 0.02 * 3));
    const Eigen::Vector3d expected = turn * (same->center.cast<double>() - offsets.spin_origin) + offsets.spin_origin;
    EXPECT_LT((s.center.cast<double>() - expected).norm(), 1e-5);
    EXPECT_LT((s.normal.cast<double>() - turn * same->normal.cast<double>()).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace rayfield::slam
