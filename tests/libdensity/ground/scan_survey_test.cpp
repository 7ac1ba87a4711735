#include "libdensity/ground/scan_survey.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/libdensity/scene.h"

namespace rayfield::density {
namespace {

using testing::kTile;

TEST(ScanSurvey, JoinsThePathOfSeveralTilesInTheOrderOfTime) {
  testing::Scene scene(2);
  scene.add_drive({{500010, 6100010}, {500040, 6100010}});  // crosses a border
  const auto surveys = testing::survey_all(scene.tiles());
  ASSERT_EQ(surveys.size(), 2U);
  const auto path = testing::scan_survey_of(surveys).path();
  ASSERT_NEAR(static_cast<double>(path.size()), 30 / 1.25 / 0.1, 2);
  for (std::size_t i = 1; i < path.size(); ++i) {
    EXPECT_GT(path[i].time_s, path[i - 1].time_s);
    EXPECT_GT(path[i].position.x(), path[i - 1].position.x());
  }
  for (const PathPoint& p : path) {
    EXPECT_NEAR(p.position.y(), 6100010, 1e-3);
    EXPECT_NEAR(p.position.z(), 101.8, 1e-3);
  }
}

TEST(ScanSurvey, TellsScansThatKeepTheirDownwardRaysWithoutAReturnFromThoseThatDropThem) {
  const auto survey = [](int above, int below, int steep) {
    tile::SegmentBatch batch;
    const auto push = [&](double rise, std::uint8_t flags) {
      batch.entry.push_back({500001, 6100001, 101}), batch.exit.push_back({500011, 6100001, 101 + 10 * rise});
      batch.time_s.push_back(1), batch.intensity.push_back(0), batch.flags.push_back(flags);
    };
    for (int i = 0; i < above; ++i) push(0.1, tile::kEndsHere);
    for (int i = 0; i < below; ++i) push(-0.02, tile::kEndsHere);
    for (int i = 0; i < steep; ++i) push(-0.5, tile::kEndsHere);
    push(-0.02, tile::kEndsHere | tile::kHit), push(-0.02, 0);  // a hit; one that ends in another tile
    SurveyAccumulator sum({{20000, 244000}, kTile}, {});
    sum.add(batch);
    return sum.finish();
  };
  EXPECT_EQ(survey(3, 2, 1).misses.above, 3);
  EXPECT_EQ(survey(3, 2, 1).misses.below, 2);
  EXPECT_FALSE(ScanSurvey().holds_downward_misses());
  EXPECT_FALSE(testing::scan_survey_of({survey(600, 0, 50), survey(400, 19, 0)}).holds_downward_misses());
  EXPECT_TRUE(testing::scan_survey_of({survey(600, 0, 0), survey(400, 21, 0)}).holds_downward_misses());
}

TEST(ScanSurvey, KnowsWhatWasSeenOfEachTileInWhateverOrderTheyCome) {
  testing::Scene scene(3);
  scene.add_drive({{500010, 6100010}, {500040, 6100010}});
  scene.add_ground({500000, 6100000}, {500050, 6100025}, 20, 0.01);
  std::vector<TileSurvey> surveys = testing::survey_all(scene.tiles());
  ASSERT_GE(surveys.size(), 2U);
  const ScanSurvey forwards = testing::scan_survey_of(surveys);
  std::reverse(surveys.begin(), surveys.end());
  const ScanSurvey backwards = testing::scan_survey_of(surveys);
  for (const TileSurvey& survey : surveys) {
    EXPECT_EQ(forwards.coverage().at(survey.index).values, survey.coverage.values);
    EXPECT_EQ(backwards.coverage().at(survey.index).values, survey.coverage.values);
  }
  ASSERT_EQ(forwards.path().size(), backwards.path().size());
  for (std::size_t i = 0; i < forwards.path().size(); ++i)
    EXPECT_EQ(forwards.path()[i].position, backwards.path()[i].position);
}

}  // namespace
}  // namespace rayfield::density
