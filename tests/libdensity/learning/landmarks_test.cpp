#include "rayfield/density/landmarks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/libdensity/simulated_block.h"

namespace rayfield::density {
namespace {

using testing::Block;
using testing::drive_with;
using testing::take;

BlockLandmarks landmarks_in(Block& block, const std::string& scan_id) {
  Progress progress;
  return take(find_landmarks(block.store(), scan_id, {}, progress));
}

TEST(Landmarks, OfTwoDrivesStandAtTheSamePlaces) {
  Block first, second;
  first.add("2019-08-01", drive_with(0.0, 1));
  second.add("2019-12-01", drive_with(0.6, 2));
  const BlockLandmarks bare = landmarks_in(first, "2019-08-01"), leafy = landmarks_in(second, "2019-12-01");
  // Two rows of four panels have ten posts.
  EXPECT_EQ(std::count_if(bare.uprights.begin(), bare.uprights.end(), [](const Upright& u) { return u.post; }), 10);
  EXPECT_EQ(bare.rows.size(), 2U);
  EXPECT_NEAR(bare.row_spacing_m, 2.5, 0.05);
  EXPECT_NEAR(bare.post_spacing_m, 3.5, 0.05);
  std::size_t near = 0;
  for (const Upright& upright : leafy.uprights)
    near += std::any_of(bare.uprights.begin(), bare.uprights.end(),
                        [&](const Upright& other) { return (other.position - upright.position).norm() < 0.05; });
  EXPECT_GE(near, leafy.uprights.size() * 8 / 10);
  std::size_t known = 0;
  for (const float height : bare.ground.values) known += std::isfinite(height) ? 1 : 0;
  EXPECT_GT(known, 100U) << "the ground beside the track, in square metres";
}

TEST(Landmarks, AreOfTheLayoutThatTheStoreKeeps) {
  Block block;
  Progress progress;
  EXPECT_FALSE(take(reference_landmarks(block.store(), {}, "test", progress))) << "an empty store has no reference";
  block.add("2019-08-01", drive_with(0.0, 1));
  const auto found = take(reference_landmarks(block.store(), {}, "test", progress));
  ASSERT_TRUE(found);
  const tile::Snapshot published = block.snapshot();
  EXPECT_FALSE(published.registry.empty()) << "the layout is published with it";
  const auto again = take(reference_landmarks(block.store(), {}, "test", progress));
  EXPECT_EQ(block.snapshot().number, published.number) << "and found once";
  ASSERT_EQ(again->uprights.size(), found->uprights.size());
  for (std::size_t i = 0; i < found->uprights.size(); ++i)
    EXPECT_EQ(again->uprights[i].position, found->uprights[i].position);
  block.process();
  EXPECT_EQ(take(reference_landmarks(block.store(), {}, "test", progress))->uprights.size(), found->uprights.size());
}

}  // namespace
}  // namespace rayfield::density
