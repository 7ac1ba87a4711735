#include "libdensity/posts/stem_thickness.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace rayfield::density {
namespace {

struct Rows {
  std::vector<std::vector<PlacedStem>> stems;
  std::vector<std::vector<std::size_t>> sure;

  // A row of 21 m: strainers of 60 mm at its ends, vines of 22 to 28 mm at every metre but at every fifth a post.
  void add(double post_radius_m, bool posts_are_sure, const std::vector<int>& tall_vines = {}) {
    std::vector<PlacedStem> row;
    std::vector<std::size_t> sure_of_row;
    for (int i = 0; i <= 20; ++i) {
      const bool strainer = i % 20 == 0, post = i % 5 == 0;
      PlacedStem stem{{}, static_cast<double>(i), 0};
      stem.stem.radius_m = strainer ? 0.06 : post ? post_radius_m : 0.02 + 0.002 * (3 * i % 5);
      bool sure_post = strainer || (post && posts_are_sure);
      for (const int tall : tall_vines) sure_post = sure_post || tall == i;
      if (sure_post) sure_of_row.push_back(row.size());
      row.push_back(stem);
    }
    stems.push_back(row), sure.push_back(sure_of_row);
  }
  StemThickness thickness() const { return stem_thickness(stems, sure); }
};

TEST(StemThickness, TellsPostsThatAreThickerThanVines) {
  Rows rows;
  rows.add(0.04, false, {3, 12});
  rows.add(0.04, false, {8});
  const StemThickness thickness = rows.thickness();
  EXPECT_TRUE(thickness.tells_posts);
  EXPECT_NEAR(thickness.trunk_m, 0.025, 0.002);
  EXPECT_EQ(without_thin(rows.stems[0], rows.sure[0], thickness), (std::vector<std::size_t>{0, 20}));
}

TEST(StemThickness, KeepsWhatIsSeenToBeSolid) {
  Rows rows;
  rows.add(0.04, false, {3, 12});
  rows.add(0.04, false);
  rows.stems[0][12].stem.solidity = 5;
  EXPECT_EQ(without_thin(rows.stems[0], rows.sure[0], rows.thickness()), (std::vector<std::size_t>{0, 12, 20}));
}

// Line posts of steel between strainers of wood.
TEST(StemThickness, OfPostsAsThinAsVinesTellsNothing) {
  Rows rows;
  rows.add(0.022, true);
  rows.add(0.022, true);
  const StemThickness thickness = rows.thickness();
  EXPECT_FALSE(thickness.tells_posts);
  EXPECT_EQ(without_thin(rows.stems[0], rows.sure[0], thickness), rows.sure[0]);
}

TEST(StemThickness, WithoutStemsTellsNothing) {
  EXPECT_FALSE(stem_thickness({}, {}).tells_posts);
  EXPECT_FALSE(stem_thickness({{}}, {{}}).tells_posts);
}

}  // namespace
}  // namespace rayfield::density
