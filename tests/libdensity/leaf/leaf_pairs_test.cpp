#include "libdensity/leaf/leaf_pairs.h"

#include <gtest/gtest.h>

#include "libdensity/voxels/voxel_accumulator.h"
#include "tests/libdensity/hedge_scene.h"

namespace rayfield::density {
namespace {

using testing::Hedge;
using testing::HedgeOptions;
using testing::ScanOptions;

constexpr double kLeaf_m2 = 0.0080, kTwig_m2 = 0.0012;
constexpr double kVoxel_m = 0.06, kHalfWidth_m = 0.72, kTop_m = 2.4;

/// Small squares stand for canes.
Hedge twigs() {
  HedgeOptions options;
  options.leaf_size_m2 = kTwig_m2, options.leaf_area_per_m = 0.8, options.seed = 5;
  return Hedge(options);
}

Hedge leaves(double per_metre) {
  HedgeOptions options;
  options.leaf_size_m2 = kLeaf_m2, options.leaf_area_per_m = per_metre, options.seed = 6;
  return Hedge(options);
}

/// One lane, every beam, so that scans of two scenes have the same beams.
ScanOptions drive(std::uint64_t seed) {
  ScanOptions scan;
  scan.both_sides = false, scan.everything = true, scan.seed = seed;
  return scan;
}

/// What a scene of both would return.
tile::SegmentBatch nearer(tile::SegmentBatch a, const tile::SegmentBatch& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if ((b.flags[i] & tile::kHit) != 0 && (b.exit[i] - b.entry[i]).norm() < (a.exit[i] - a.entry[i]).norm())
      a.exit[i] = b.exit[i], a.flags[i] = b.flags[i], a.intensity[i] = b.intensity[i];
  return a;
}

std::vector<TileVoxels> count(const tile::SegmentBatch& rays) {
  const std::vector<RowSegment> grid = twigs().row_segments(kVoxel_m, kHalfWidth_m, kTop_m);
  VoxelOptions count_all;
  count_all.sure_return_m = 0;  // no ray of these scans is missing
  std::vector<TileVoxels> tiles;
  for (int iy = -1; iy <= 0; ++iy)
    for (int ix = -1; ix <= 0; ++ix) {
      auto accumulator = VoxelAccumulator::create({{ix, iy}, 1000}, grid, {}, count_all);
      EXPECT_TRUE(accumulator.has_value() && accumulator->add(rays).has_value());
      tiles.push_back(std::move(*accumulator).finish());
    }
  return tiles;
}

LeafPairs pairs_of(const std::vector<TileVoxels>& plant, const std::vector<TileVoxels>& wood) {
  LeafPairs pairs;
  for (std::size_t i = 0; i < plant.size(); ++i) pairs.add(plant[i], wood[i]);
  return pairs;
}

double size_of_all(const std::vector<TileVoxels>& tiles) {
  LeafSizePairs pairs;
  for (const TileVoxels& tile : tiles) pairs += tile.pairs;
  return estimate_leaf_size(pairs).area_m2;
}

TEST(LeafPairs, TellTheSizeOfLeavesAmongSmallWoodWhereAllHitsTogetherDoNot) {
  const auto wood = count(twigs().scan(drive(11)));
  for (const double per_metre : {0.8, 3.0}) {
    const auto plant = count(nearer(twigs().scan(drive(12)), leaves(per_metre).scan(drive(12))));
    const auto size = pairs_of(plant, wood).leaf_size_m2();
    ASSERT_TRUE(size.has_value());
    EXPECT_NEAR(*size, kLeaf_m2, 0.15 * kLeaf_m2) << per_metre << " m²/m";
    EXPECT_GT(std::abs(size_of_all(plant) - kLeaf_m2), std::abs(*size - kLeaf_m2)) << per_metre << " m²/m";
  }
  const auto early = count(nearer(twigs().scan(drive(12)), leaves(0.8).scan(drive(12))));
  EXPECT_LT(size_of_all(early), 0.75 * kLeaf_m2);
}

TEST(LeafPairs, KnowHowMuchOfTheWoodLeavesHide) {
  const auto bare = twigs().scan(drive(12)), leafy = leaves(3).scan(drive(12));
  double shown = 0, all = 0;
  for (std::size_t i = 0; i < bare.size(); ++i) {
    if ((bare.flags[i] & tile::kHit) == 0) continue;
    const bool hidden = (leafy.flags[i] & tile::kHit) != 0 &&
                        (leafy.exit[i] - leafy.entry[i]).norm() < (bare.exit[i] - bare.entry[i]).norm();
    all += 1, shown += hidden ? 0 : 1;
  }
  ASSERT_LT(shown, 0.8 * all);
  const LeafPairs pairs = pairs_of(count(nearer(bare, leafy)), count(twigs().scan(drive(11))));
  EXPECT_NEAR(pairs.wood_share(), shown / all, 0.05);
}

TEST(LeafPairs, OfASecondBareDriveOrOfTheSameScanSayNothing) {
  const auto wood = count(twigs().scan(drive(11))), again = count(twigs().scan(drive(12)));
  EXPECT_EQ(pairs_of(again, wood).leaf_size_m2(), std::nullopt);
  EXPECT_EQ(pairs_of(wood, wood).leaf_size_m2(), std::nullopt);
  EXPECT_EQ(LeafPairs().leaf_size_m2(), std::nullopt);
}

}  // namespace
}  // namespace rayfield::density
