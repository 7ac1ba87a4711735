#include "libdensity/learning/learn.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/libdensity/layout_support.h"

namespace rayfield::density {
namespace {

using namespace testing;

// A scan that shows all of a layout; what it lacks or adds is up to the test.
DatedEvidence sees(const RowLayout& layout, const std::string& date) {
  DatedEvidence dated{date, date, {}};
  dated.evidence.stems = stems_of(layout);
  for (const Row& row : layout.rows) dated.evidence.rows.push_back({row.number, true, 1.0});
  for (const double east : {-1.5, 1.5, 4.5, 7.5}) {
    std::vector<Eigen::Vector2d> pass;
    for (double n = -3; n <= 27; n += 0.5) pass.push_back(kCorner + Eigen::Vector2d(east, n));
    dated.evidence.passes.push_back(std::move(pass));
  }
  return dated;
}

void hide(DatedEvidence& dated, const Eigen::Vector2d& p, double radius_m = 0.1) {
  std::erase_if(dated.evidence.stems, [&](const Stem& s) { return (s.position - p).norm() < radius_m; });
}

void show_post(DatedEvidence& dated, int row, const Eigen::Vector2d& p, double radius_m = 0.05) {
  dated.evidence.stems.push_back({row, p, Eigen::Vector2d::Zero(), radius_m, 1.75, 10, 1.0, 0});
}

RowLayout learn(const RowLayout& found, const std::vector<DatedEvidence>& evidence) {
  Learner learner(found, {}, {}, kCrs);
  for (const DatedEvidence& dated : evidence) learner.take(dated);
  return learner.layout();
}

Eigen::Vector2d place(double east_m, double north_m) { return kCorner + Eigen::Vector2d(east_m, north_m); }

void expect_same_panels(const RowLayout& a, const RowLayout& b) {
  ASSERT_EQ(a.panels.size(), b.panels.size());
  for (std::size_t i = 0; i < a.panels.size(); ++i) {
    EXPECT_EQ(a.panels[i].identity.uid, b.panels[i].identity.uid);
    EXPECT_EQ(a.panels[i].start_m, b.panels[i].start_m);
    EXPECT_EQ(a.panels[i].end_m, b.panels[i].end_m);
  }
}

TEST(Learner, ChangesNothingWhereScansShowWhatIsKnown) {
  const RowLayout found = trellis();
  const RowLayout now = learn(found, {sees(found, "2021-05-01"), sees(found, "2021-06-01"), sees(found, "2021-07-01")});
  EXPECT_EQ(now.rows.size(), found.rows.size());
  ASSERT_EQ(now.posts.size(), found.posts.size());
  for (const Post& post : now.posts) EXPECT_EQ(post.identity.valid_from + post.identity.valid_to, "");
  expect_same_panels(now, found);
}

TEST(Learner, SeesAPostThatWasPlacedBySpacing) {
  RowLayout found = trellis();
  found.posts[2].detected = false;
  const std::string uid = found.posts[2].identity.uid;
  DatedEvidence second = sees(found, "2021-06-01");
  show_post(second, 1, place(0.03, 12.08), 0.06);
  const RowLayout now = learn(found, {sees(found, "2021-05-01"), second});
  EXPECT_TRUE(now.posts[2].detected);
  EXPECT_EQ(now.posts[2].identity.uid, uid);
  EXPECT_EQ(now.posts[2].position, place(0.03, 12.08));
  EXPECT_EQ(now.posts[2].chainage_m, 12.0) << "the panels' border stays";
  expect_same_panels(now, found);
  EXPECT_FALSE(layout_on(now, "2021-05-01").posts[2].detected) << "the earlier scan is as it was";
  EXPECT_TRUE(layout_on(now, "2021-06-01").posts[2].detected);
}

TEST(Learner, TakesAnUnknownPostOnlyOnItsSecondDateInOnePlace) {
  const RowLayout found = trellis();
  DatedEvidence may = sees(found, "2021-05-01"), june = sees(found, "2021-06-01"), july = sees(found, "2021-07-01");
  show_post(june, 2, place(3.02, 9.0));
  EXPECT_EQ(learn(found, {may, june}).posts.size(), found.posts.size()) << "once may be a cane";
  DatedEvidence elsewhere = july;
  show_post(elsewhere, 2, place(3.02, 9.3));
  EXPECT_EQ(learn(found, {may, june, elsewhere}).posts.size(), found.posts.size()) << "30 cm apart are two things";
  DatedEvidence same_day = june;
  same_day.scan_id = "2021-06-01_b";
  EXPECT_EQ(learn(found, {may, june, same_day}).posts.size(), found.posts.size()) << "two drives, one date";

  show_post(july, 2, place(3.00, 9.02));
  const RowLayout now = learn(found, {may, june, july});
  ASSERT_EQ(now.posts.size(), found.posts.size() + 1);
  const Post& post = now.posts.back();
  EXPECT_EQ(post.row, 2);
  EXPECT_NEAR((post.position - place(3.01, 9.01)).norm(), 0, 1e-9);
  EXPECT_EQ(post.identity.valid_from, "2021-06-01");
  EXPECT_EQ(post.identity.source, "found in 2021-06-01");
  EXPECT_FALSE(post.identity.uid.empty());
  EXPECT_FALSE(post.identity.used_on("2021-06-01")) << "the scan of June was processed without it";
  EXPECT_TRUE(post.identity.used_on("2021-07-01"));
  expect_same_panels(now, found);
}

TEST(Learner, TakesNoTrunkAndNoThinCaneForAPost) {
  const RowLayout found = trellis();
  std::vector<DatedEvidence> scans{sees(found, "2021-05-01"), sees(found, "2021-06-01"), sees(found, "2021-07-01")};
  for (DatedEvidence& scan : scans) {
    show_post(scan, 1, place(0.04, 8.25));       // where a vine stands
    show_post(scan, 2, place(3.1, 9.1), 0.015);  // thinner than posts are
  }
  EXPECT_EQ(learn(found, scans).posts.size(), found.posts.size());
}

TEST(Learner, LearnsNothingFromAScanThatIsNotInPlace) {
  const RowLayout found = trellis();
  std::vector<DatedEvidence> scans;
  for (const char* date : {"2021-05-01", "2021-06-01", "2021-07-01"}) {
    scans.push_back(sees(found, date));
    for (Stem& stem : scans.back().evidence.stems) stem.position += Eigen::Vector2d(0, 0.4);
  }
  const RowLayout now = learn(found, scans);
  EXPECT_EQ(now.posts.size(), found.posts.size());
  for (const Post& post : now.posts) EXPECT_EQ(post.identity.valid_to, "");
}

TEST(Learner, APostIsGoneAfterTwoDatesOnWhichItsNeighboursWereSeen) {
  const RowLayout found = trellis();
  DatedEvidence may = sees(found, "2021-05-01"), june = sees(found, "2021-06-01"), july = sees(found, "2021-07-01");
  hide(june, place(3, 12)), hide(july, place(3, 12));
  EXPECT_EQ(learn(found, {may, june}).posts[7].identity.valid_to, "") << "not seen once is not gone";
  const RowLayout now = learn(found, {may, june, july});
  EXPECT_EQ(now.posts[7].identity.valid_to, "2021-06-01");
  EXPECT_TRUE(now.posts[7].identity.used_on("2021-06-01")) << "the scan of June was processed with it";
  EXPECT_FALSE(layout_on(now, "2021-07-01").posts[7].detected);
  expect_same_panels(now, found);
  for (std::size_t i = 0; i < now.posts.size(); ++i)
    if (i != 7) {
      EXPECT_EQ(now.posts[i].identity.valid_to, "") << i;
    }
  // Seen in between: the count begins anew.
  EXPECT_EQ(learn(found, {may, june, sees(found, "2021-06-15"), july}).posts[7].identity.valid_to, "");
}

TEST(Learner, APostHiddenWithItsNeighboursIsNotGone) {
  const RowLayout found = trellis();
  std::vector<DatedEvidence> scans;
  for (const char* date : {"2021-05-01", "2021-06-01", "2021-07-01", "2021-08-01"}) {
    scans.push_back(sees(found, date));
    hide(scans.back(), place(3, 12), 1.0);  // a thicket: the post and the vines beside it
  }
  for (const Post& post : learn(found, scans).posts) EXPECT_EQ(post.identity.valid_to, "");
}

TEST(Learner, APartOfTheBlockOrASkippedLaneTakesNothingAway) {
  const RowLayout found = trellis();
  std::vector<DatedEvidence> scans{sees(found, "2021-05-01")};
  for (const char* date : {"2021-06-01", "2021-07-01", "2021-08-01"}) {
    DatedEvidence part = sees(found, date);
    std::erase_if(part.evidence.stems, [](const Stem& s) { return s.row == 3 || s.position.y() > kCorner.y() + 13; });
    part.evidence.rows[2] = {3, false, 0.2};  // not driven along
    scans.push_back(part);
  }
  const RowLayout now = learn(found, scans);
  for (const Row& row : now.rows) EXPECT_EQ(row.identity.valid_to, "");
  for (const Post& post : now.posts) EXPECT_EQ(post.identity.valid_to, "") << post.chainage_m;
  expect_same_panels(now, found);
}

TEST(Learner, ARowThatWasDrivenAlongAndIsNotThereTwiceIsPulledOut) {
  const RowLayout found = trellis();
  std::vector<DatedEvidence> scans{sees(found, "2021-05-01")};
  for (const char* date : {"2021-06-01", "2021-07-01"}) {
    DatedEvidence scan = sees(found, date);
    std::erase_if(scan.evidence.stems, [](const Stem& s) { return s.row == 2; });
    scan.evidence.rows[1].canopy = false;
    scans.push_back(scan);
  }
  EXPECT_EQ(learn(found, {scans[0], scans[1]}).rows[1].identity.valid_to, "");
  const RowLayout now = learn(found, scans);
  EXPECT_EQ(now.rows[1].identity.valid_to, "2021-06-01");
  EXPECT_EQ(layout_on(now, "2021-06-01").rows.size(), 3U) << "measured as empty then, and left at that";
  EXPECT_EQ(layout_on(now, "2021-07-01").rows.size(), 2U);
  EXPECT_EQ(now.posts[7].identity.valid_to, "2021-06-01");
  expect_same_panels(now, found);

  for (DatedEvidence& scan : scans) scan.evidence.rows[1].canopy = true;
  EXPECT_EQ(learn(found, scans).rows[1].identity.valid_to, "") << "stems hidden in a canopy that stands";
}

TEST(Learner, AppendsANewRowUnderANumberOfItsOwn) {
  const RowLayout found = trellis();
  DatedEvidence june = sees(found, "2021-06-01");
  RowLayout planted;
  planted.rows.push_back(straight_row(1, 9));
  for (int p = 0; p <= 4; ++p) planted.posts.push_back(post_at(1, 9, 6.0 * p));
  planted.trunks.push_back({1, 3, 0, place(9, 3), 0.02, 0.8});
  make_panels(planted, std::nullopt);
  june.evidence.new_rows = planted;
  const RowLayout now = learn(found, {sees(found, "2021-05-01"), june});
  ASSERT_EQ(now.rows.size(), 4U);
  const Row& row = now.rows[3];
  EXPECT_EQ(row.number, 4);
  EXPECT_EQ(row.identity.valid_from, "2021-06-01") << "May drove along here and saw nothing";
  EXPECT_FALSE(row.identity.uid.empty());
  EXPECT_EQ(layout_on(now, "2021-05-01").rows.size(), 3U);
  const RowLayout used = layout_on(now, "2021-06-01");
  EXPECT_EQ(used.rows.size(), 4U);
  EXPECT_EQ(used.panels.size(), found.panels.size() + 4);
  EXPECT_EQ(used.trunks.size(), found.trunks.size() + 1);
  for (std::size_t i = 0; i < found.panels.size(); ++i)
    EXPECT_EQ(now.panels[i].identity.uid, found.panels[i].identity.uid);

  // Nobody drove there before: the row may always have stood.
  DatedEvidence may = sees(found, "2021-05-01");
  may.evidence.passes.pop_back();
  EXPECT_EQ(learn(found, {may, june}).rows[3].identity.valid_from, "");
  // The same row found again by the next scan is that one.
  DatedEvidence july = june;
  july.date = july.scan_id = "2021-07-01";
  EXPECT_EQ(learn(found, {may, june, july}).rows.size(), 4U);
}

TEST(Learner, GivesANewRowANumberThatTheFarmDoesNotUse) {
  RowLayout found = trellis();
  for (Row& row : found.rows) row.farm_number = row.number + 3;  // 4, 5, 6
  DatedEvidence june = sees(found, "2021-06-01");
  june.evidence.new_rows.rows.push_back(straight_row(1, 9));
  make_panels(june.evidence.new_rows, std::nullopt);
  const RowLayout now = learn(found, {june});
  ASSERT_EQ(now.rows.size(), 4U);
  EXPECT_EQ(now.rows[3].number, 4);
  EXPECT_EQ(now.rows[3].shown_number(), 7);
}

TEST(ScanEvidence, IsStoredAndReadBack) {
  const RowLayout found = trellis(2);
  DatedEvidence dated = sees(found, "2021-05-01");
  dated.evidence.new_rows.rows.push_back(straight_row(1, 9));
  make_panels(dated.evidence.new_rows, std::nullopt);
  dated.evidence.rows[1] = {2, false, 0.25};
  const tile::ArraySet stored = evidence_to_arrays(dated.evidence);
  const auto back = evidence_from_arrays(stored);
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->stems, dated.evidence.stems);
  EXPECT_EQ(back->passes, dated.evidence.passes);
  EXPECT_FALSE(back->rows[1].canopy);
  EXPECT_EQ(back->rows[1].driven, 0.25);
  EXPECT_EQ(back->new_rows.rows[0].centreline, dated.evidence.new_rows.rows[0].centreline);
  tile::ArraySet wrong = stored;
  std::get<std::vector<std::int32_t>>(wrong.columns["pass_vertices"])[0] = 1 << 30;
  EXPECT_EQ(evidence_from_arrays(wrong).error().code, ErrorCode::damaged);
  wrong = stored;
  wrong.columns.erase("stem_radius_m");
  EXPECT_EQ(evidence_from_arrays(wrong).error().code, ErrorCode::damaged);
}

}  // namespace
}  // namespace rayfield::density
