#include "libdensity/registry/identity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "libdensity/registry/layout_arrays.h"
#include "rayfield/core/uuid.h"
#include "tests/libdensity/layout_support.h"

namespace rayfield::density {
namespace {

using namespace testing;

TEST(Identity, OfALayoutWithoutIdentitiesIsThatOfItsPlaces) {
  RowLayout layout = trellis(1);
  tile::ArraySet old = layout_to_arrays(layout);
  for (const char* kind : {"row_", "panel_", "post_"})
    for (const char* column : {"uid", "valid_from", "valid_to", "used_from", "used_to", "source"})
      old.columns.erase(std::string(kind) + column);
  old.columns.erase("row_name"), old.columns.erase("row_farm_number");
  auto back = layout_from_arrays(old);
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_TRUE(back->rows[0].identity.uid.empty());
  name_by_place(*back, kCrs);
  // The rule of the first versions: centimetres of the ends, of the borders, of the place.
  EXPECT_EQ(back->rows[0].identity.uid,
            named_uuid("rayfield row EPSG:7854", "500000.00 6100000.00 500000.00 6100024.00"));
  EXPECT_EQ(back->panels[1].identity.uid,
            named_uuid("rayfield panel EPSG:7854", "500000.00 6100006.00 500000.00 6100012.00"));
  EXPECT_EQ(back->posts[2].identity.uid, named_uuid("rayfield post EPSG:7854", "500000.00 6100012.00"));
}

TEST(Identity, IsStoredWithTheLayout) {
  RowLayout layout = trellis(2);
  layout.rows[1].name = "Réihe, \"12\"", layout.rows[1].farm_number = 112;
  layout.posts[3].identity.valid_from = "2021-05-01", layout.posts[3].identity.used_to = "2022-01-01";
  layout.panels[0].identity.source = "found in 2021-05-01";
  const auto back = layout_from_arrays(layout_to_arrays(layout));
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->rows[1].name, layout.rows[1].name);
  EXPECT_EQ(back->rows[1].shown_number(), 112);
  EXPECT_EQ(back->rows[0].shown_number(), 1);
  EXPECT_EQ(back->posts[3].identity.valid_from, "2021-05-01");
  EXPECT_EQ(back->posts[3].identity.used_to, "2022-01-01");
  EXPECT_EQ(back->panels[0].identity.source, "found in 2021-05-01");
  for (std::size_t i = 0; i < layout.panels.size(); ++i)
    EXPECT_EQ(back->panels[i].identity.uid, layout.panels[i].identity.uid);

  tile::ArraySet wrong = layout_to_arrays(layout);
  std::get<std::vector<std::uint8_t>>(wrong.columns["post_uid"]).pop_back();
  EXPECT_EQ(layout_from_arrays(wrong).error().code, ErrorCode::damaged);
}

TEST(Identity, IsGivenOnceWhereSomethingStoodBefore) {
  RowLayout layout = trellis(1);
  layout.posts.push_back(layout.posts[2]);
  layout.posts.back().identity = {};
  name_by_place(layout, kCrs);
  EXPECT_NE(layout.posts.back().identity.uid, layout.posts[2].identity.uid);
}

// Surveyed geometry differs by centimetres, and may run the other way.
TEST(Identity, IsKeptWhenGeometryIsRefined) {
  const RowLayout known = trellis(3);
  RowLayout refined = known;
  for (Row& row : refined.rows) {
    row.identity = {}, row.identity.source = "surveyed";
    for (Eigen::Vector2d& p : row.centreline) p += Eigen::Vector2d(0.04, -0.06);
    std::reverse(row.centreline.begin(), row.centreline.end());
  }
  for (Post& post : refined.posts)
    post.identity = {}, post.position += Eigen::Vector2d(0.04, -0.06), post.chainage_m = 24 - post.chainage_m;
  std::reverse(refined.posts.begin(), refined.posts.end());
  make_panels(refined, std::nullopt);
  take_over_identities(known, refined);
  for (std::size_t i = 0; i < known.rows.size(); ++i) {
    EXPECT_EQ(refined.rows[i].identity.uid, known.rows[i].identity.uid);
    EXPECT_EQ(refined.rows[i].identity.source, "surveyed");
  }
  for (std::size_t i = 0; i < known.posts.size(); ++i)
    EXPECT_EQ(refined.posts[i].identity.uid, known.posts[known.posts.size() - 1 - i].identity.uid);
  std::set<std::string> before, after;
  for (const Panel& panel : known.panels) before.insert(panel.identity.uid);
  for (const Panel& panel : refined.panels) after.insert(panel.identity.uid);
  EXPECT_EQ(before, after);
}

TEST(Identity, IsNotGivenToWhatStandsElsewhere) {
  const RowLayout known = trellis(2);
  RowLayout other;
  other.rows.push_back(straight_row(1, 6));  // the third row's place
  other.posts.push_back(post_at(1, 6, 12));
  make_panels(other, std::nullopt);
  take_over_identities(known, other);
  EXPECT_TRUE(other.rows[0].identity.uid.empty());
  EXPECT_TRUE(other.posts[0].identity.uid.empty());
  for (const Panel& panel : other.panels) EXPECT_TRUE(panel.identity.uid.empty());
}

TEST(LayoutOn, TakesWhatIsInUseOnTheDate) {
  RowLayout layout = trellis(2);
  layout.rows[1].identity.used_from = "2021-06-01", layout.rows[1].identity.used_to = "2022-06-01";
  layout.posts[1].identity.used_from = "2021-07-01";
  const RowLayout before = layout_on(layout, "2021-05-31");
  EXPECT_EQ(before.rows.size(), 1U);
  EXPECT_EQ(before.panels.size(), 4U);
  EXPECT_EQ(before.posts.size(), 5U);
  EXPECT_FALSE(before.posts[1].detected) << "its wood is not known yet";
  EXPECT_TRUE(before.posts[2].detected);
  EXPECT_EQ(layout_on(layout, "2021-06-01").rows.size(), 2U);
  EXPECT_TRUE(layout_on(layout, "2021-07-01").posts[1].detected);
  EXPECT_EQ(layout_on(layout, "2022-06-01").rows.size(), 1U);
}

}  // namespace
}  // namespace rayfield::density
