#include <gtest/gtest.h>

#include "libdensity/echoes/wood_echoes.h"
#include "tests/libdensity/echoes/leaf_echoes.h"

/// Which echoes are of bare vines: EchoModel::wood_returned.
namespace rayfield::density {
namespace {

TEST(EchoModel, WhereMostIsWoodPostsTellAFullEcho) {
  EchoStatistics statistics = whole_leaves(0.03, 0.8);
  add_posts(statistics, 2000);
  EXPECT_FALSE(estimate_echo_model(statistics, lidar(0.03))->wood_returned);
  add_posts(statistics, 2000);
  const auto model = estimate_echo_model(statistics, lidar(0.03));
  ASSERT_TRUE(model && model->wood_returned);
  EXPECT_NEAR(model->full_echo, kFull, 1e-9);
  EXPECT_NEAR(model->detection_share, 0.8 * 0.712 / 1.03, 0.003);  // 2 % of 0.7 … 1.3 are below 0.712
  EXPECT_EQ(model->lost_share, 0);
}

// A block with few posts: canes are as many to each echo of a post as leaves are elsewhere, but a third as strong as
// posts.
TEST(EchoModel, EchoesFarBelowThoseOfPostsAreOfCanes) {
  EchoStatistics statistics = whole_leaves(0.03, 0.3);
  add_posts(statistics, 500);
  EXPECT_TRUE(estimate_echo_model(statistics, lidar(0.03))->wood_returned);
  EchoKnowledge known = lidar(0.03);
  known.full_echo = 0.4 * kFull;
  EXPECT_FALSE(estimate_echo_model(statistics, known)->wood_returned);  // told
}

TEST(EchoModel, BareVinesWithoutPostsTellNothing) {
  EchoStatistics statistics = whole_leaves(0.03, 0.8, 6000);
  add_posts(statistics, 199);
  EXPECT_FALSE(estimate_echo_model(statistics, lidar(0.03))->wood_returned);  // 30 to one: leaves
  EchoKnowledge known = lidar(0.03);
  known.foliage = Foliage::none;
  EXPECT_FALSE(estimate_echo_model(statistics, known).has_value());
  add_posts(statistics, 1);
  EXPECT_TRUE(estimate_echo_model(statistics, known)->wood_returned);
  EchoStatistics few = whole_leaves(0.03, 0.8, 1000);
  add_posts(few, 199);
  EXPECT_FALSE(estimate_echo_model(few, lidar(0.03)).has_value());
}

/// Whether 6000 echoes beside so many of posts are taken for those of bare vines. `ends`: of rays that pass a hit and
/// end behind it (add_ends_behind()); negative: no ray passes any.
bool is_bare(int posts, Foliage foliage, int ends = -1) {
  EchoStatistics statistics = whole_leaves(0.03, 0.8, 6000);
  add_posts(statistics, posts);
  if (ends >= 0) add_close_pairs(statistics);
  if (ends > 0) add_ends_behind(statistics, ends);
  EchoKnowledge known = lidar(0.03);
  known.foliage = foliage;
  return estimate_echo_model(statistics, known)->wood_returned.has_value();
}

// Canes stand by themselves, leaves before leaves.
TEST(EchoModel, FewEchoesBesideThoseOfPostsAreOfLeavesWhereMoreEndsBehindThem) {
  EXPECT_TRUE(is_bare(800, Foliage::unknown, 0));     // 7.5 to one, nothing behind them
  EXPECT_FALSE(is_bare(740, Foliage::unknown, 0));    // 8.1 to one
  EXPECT_FALSE(is_bare(1450, Foliage::unknown, 80));  // 4.1 to one, 0.5 ends per metre
  EXPECT_TRUE(is_bare(1550, Foliage::unknown, 80));   // 3.9 to one
  EXPECT_TRUE(is_bare(1550, Foliage::unknown, 800));  // however many end there
  EXPECT_TRUE(is_bare(960, Foliage::unknown, 28));    // 6.3 to one, 0.18
  EXPECT_FALSE(is_bare(960, Foliage::unknown, 36));   // 0.23
  EXPECT_TRUE(is_bare(1450, Foliage::unlikely, 80));
  EXPECT_FALSE(is_bare(1550, Foliage::likely, 80));
}

// What is leaf and what cane is asked of the month where echoes do not say it clearly.
TEST(EchoModel, FewEchoesBesideThoseOfPostsAreOfLeavesWhereLeavesAreLikely) {
  EXPECT_FALSE(is_bare(1200, Foliage::likely));  // five to one
  EXPECT_TRUE(is_bare(1200, Foliage::unknown));
  EXPECT_TRUE(is_bare(3000, Foliage::likely));   // two to one
  EXPECT_FALSE(is_bare(900, Foliage::unknown));  // seven to one
  EXPECT_TRUE(is_bare(900, Foliage::unlikely));
  EXPECT_FALSE(is_bare(600, Foliage::unlikely));  // ten to one
  EXPECT_TRUE(is_bare(600, Foliage::none));
}

// Posts of bright steel or white paint.
TEST(EchoModel, LeavesMuchDarkerThanPostsAreLeavesWhereLeavesAreLikely) {
  EchoStatistics statistics = whole_leaves(0.03, 0.3);
  add_posts(statistics, 500);
  EchoKnowledge known = lidar(0.03);
  known.foliage = Foliage::likely;
  EXPECT_FALSE(estimate_echo_model(statistics, known)->wood_returned);
}

}  // namespace
}  // namespace rayfield::density
