#include "libdensity/ground/survey.h"
#include "libdensity/ground/survey_arrays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <string>

#include "tests/libdensity/scene.h"

namespace rayfield::density {
namespace {

using testing::kTile;

tile::SegmentBatch slice(const tile::SegmentBatch& all, std::size_t from, std::size_t to) {
  tile::SegmentBatch out;
  for (std::size_t i = from; i < to; ++i) {
    out.entry.push_back(all.entry[i]), out.exit.push_back(all.exit[i]), out.time_s.push_back(all.time_s[i]);
    out.intensity.push_back(all.intensity[i]), out.flags.push_back(all.flags[i]);
  }
  return out;
}

testing::Scene busy_scene() {
  testing::Scene scene(3);
  scene.add_ground({500001, 6100001}, {500024, 6100024}, 40, 0.02);
  testing::BlockShape block;
  block.start = {500003, 6100003}, block.length_m = 18;
  scene.add_canopy(block, 0, 0, 1, 500);
  scene.drive_lanes(block, {-1.25, 1.25});
  return scene;
}

TEST(Survey, IsTheSameInWhateverOrderAndHoweverSplitTheSegmentsArrive) {
  const auto tiles = busy_scene().tiles();
  const auto& [index, batch] = *tiles.begin();
  SurveyOptions options;
  options.ground_bins = 8;  // far fewer than occupied bins, so that bins are pushed out
  SurveyAccumulator whole({index, kTile}, options);
  whole.add(batch);

  SurveyAccumulator a({index, kTile}, options), b({index, kTile}, options), c({index, kTile}, options);
  const std::size_t n = batch.size() / 24 * 8;  // whole strides: the coverage sample is by position in a chunk
  c.add(slice(batch, 2 * n, batch.size()));
  a.add(slice(batch, n, 2 * n));
  b.add(slice(batch, 0, n));
  c.merge(a), c.merge(b);

  const tile::ArraySet one = survey_to_arrays(whole.finish()), two = survey_to_arrays(c.finish());
  EXPECT_EQ(one.attributes, two.attributes);
  EXPECT_EQ(one.columns, two.columns);
}

TEST(Survey, CountsEachHitInTheTileOnceAndNoneOfTheMargin) {
  testing::Scene scene(1);
  for (double x : {499999.9, 500000.0, 500000.1, 500012.0, 500024.9, 500025.0}) scene.add_point({x, 6100010, 100});
  const auto tiles = scene.tiles();
  std::int64_t total = 0;
  for (const auto& survey : testing::survey_all(tiles)) total += survey.hits;
  EXPECT_EQ(total, 6);
  const auto surveys = testing::survey_all(tiles);
  const auto middle =
      std::find_if(surveys.begin(), surveys.end(), [](const TileSurvey& s) { return s.index.ix == 20000; });
  ASSERT_NE(middle, surveys.end());
  EXPECT_EQ(middle->hits, 4);  // 500000.0, 500000.1, 500012.0, 500024.9
}

TEST(Survey, LeavesOutSegmentsThatAreNotFinite) {
  tile::SegmentBatch batch;
  batch.entry = {{500001, 6100001, 101}, {500001, 6100001, NAN}};
  batch.exit = {{500001, 6100001, 100}, {500001, 6100001, 100}};
  batch.time_s = {1, 2}, batch.intensity = {0, 0};
  batch.flags = {tile::kHit | tile::kEndsHere, tile::kHit | tile::kEndsHere};
  SurveyAccumulator sum({{20000, 244000}, kTile}, {});
  sum.add(batch);
  EXPECT_EQ(sum.finish().hits, 1);
}

TEST(Survey, SurvivesStorage) {
  const auto tiles = busy_scene().tiles();
  const TileSurvey survey = testing::survey_all(tiles).front();
  const auto back = survey_from_arrays(survey_to_arrays(survey));
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(survey_to_arrays(*back).columns, survey_to_arrays(survey).columns);
  EXPECT_EQ(survey_to_arrays(*back).attributes, survey_to_arrays(survey).attributes);
}

TEST(Survey, RefusesStoredColumnsThatDoNotFitTogether) {
  const std::vector<TileSurvey> surveys = testing::survey_all(busy_scene().tiles());
  const auto low = [](const TileSurvey& a, const TileSurvey& b) { return a.bins.size() < b.bins.size(); };
  tile::ArraySet arrays = survey_to_arrays(*std::max_element(surveys.begin(), surveys.end(), low));
  auto& keys = std::get<std::vector<std::int32_t>>(arrays.columns["bin_key"]);
  ASSERT_FALSE(keys.empty());
  keys.pop_back();
  const auto back = survey_from_arrays(arrays);
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().code, ErrorCode::damaged);
  arrays.attributes = "{";
  EXPECT_EQ(survey_from_arrays(arrays).error().code, ErrorCode::damaged);
}

TEST(Survey, RefusesStoredCountsThatAreNone) {
  const tile::ArraySet good = survey_to_arrays(testing::survey_all(busy_scene().tiles()).front());
  for (const std::string count : {"segments", "starts", "ends", "hits", "misses_above", "misses_below"})
    for (const char* wrong : {"\"many\"", "1.5", "-1", "null"}) {
      tile::ArraySet arrays = good;
      const std::string name = "\"" + count + "\":";
      arrays.attributes = std::regex_replace(good.attributes, std::regex(name + "[0-9]+"), name + wrong);
      ASSERT_NE(arrays.attributes, good.attributes);
      const auto back = survey_from_arrays(arrays);
      ASSERT_FALSE(back) << name << wrong;
      EXPECT_EQ(back.error().code, ErrorCode::damaged);
    }
}

}  // namespace
}  // namespace rayfield::density
