#include "libdensity/ground/ground.h"
#include "libdensity/ground/ground_arrays.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/libdensity/scene.h"

namespace rayfield::density {
namespace {

using testing::Scene;

// 4 % slope and 0.3 m waves of 20 m: a rolling block.
double rolling(double x, double y) {
  return 100 + 0.04 * (x - 500000) +
         0.3 * std::sin((x - 500000) * 2 * M_PI / 20) * std::cos((y - 6100000) * 2 * M_PI / 24);
}

struct Fit {
  double bias = 0, rmse = 0;
  int unknown = 0;
};

Fit compare(const GroundModel& model, const testing::Height& truth, const Eigen::Vector2d& low,
            const Eigen::Vector2d& high) {
  Fit fit;
  int n = 0;
  for (double x = low.x(); x <= high.x(); x += 0.37)
    for (double y = low.y(); y <= high.y(); y += 0.41) {
      const auto z = model.height(x, y);
      if (!z) {
        ++fit.unknown;
        continue;
      }
      const double e = *z - truth(x, y);
      fit.bias += e, fit.rmse += e * e, ++n;
    }
  fit.bias /= n, fit.rmse = std::sqrt(fit.rmse / n);
  return fit;
}

const Eigen::Vector2d kLow(500015, 6100015), kHigh(500036, 6100036);  // four tiles meet inside

TEST(Ground, FollowsRollingGroundWithoutTheBiasOfALowerHull) {
  Scene scene(11, rolling);
  scene.add_ground({500005, 6100005}, {500045, 6100045}, 150, 0.02);
  const auto surveys = testing::survey_all(scene.tiles());
  const Fit fit = compare(testing::ground_of(surveys), rolling, kLow, kHigh);
  EXPECT_EQ(fit.unknown, 0);
  EXPECT_LT(fit.rmse, 0.010);
  EXPECT_LT(std::abs(fit.bias), 0.004);  // the noise is 0.02: a surface through lowest points would be 0.02…0.04 low
}

TEST(Ground, IsNotPulledDownByMultipathPoints) {
  Scene scene(12, rolling);
  scene.add_ground({500005, 6100005}, {500045, 6100045}, 150, 0.015);
  for (int i = 0; i < 300; ++i) {
    const double x = scene.uniform(500010, 500040), y = scene.uniform(6100010, 6100040);
    scene.add_point({x, y, rolling(x, y) - scene.uniform(0.3, 4)});
  }
  for (int i = 0; i < 5; ++i) scene.add_point({500020.11, 6100020.11, rolling(500020, 6100020) - 1.0});  // a cluster
  const Fit fit = compare(testing::ground_of(testing::survey_all(scene.tiles())), rolling, kLow, kHigh);
  EXPECT_LT(fit.rmse, 0.010);
}

TEST(Ground, SeesThroughGrassAndCanopy) {
  Scene scene(13, rolling);
  scene.add_ground({500005, 6100005}, {500045, 6100045}, 120, 0.015);
  for (int i = 0; i < 60000; ++i) {  // as many hits on blades of 4 cm mean height as half of those on soil
    const double x = scene.uniform(500008, 500042), y = scene.uniform(6100008, 6100042);
    scene.add_point({x, y, rolling(x, y) - 0.04 * std::log(scene.uniform(1e-6, 1))});
  }
  testing::BlockShape block;
  block.start = {500010, 6100012}, block.azimuth_deg = 30;
  for (double across : {0.0, -2.5, -5.0}) scene.add_canopy(block, across, 0, 1, 800, 0.2, 0.4, 1.8);
  const Fit fit = compare(testing::ground_of(testing::survey_all(scene.tiles())), rolling, kLow, kHigh);
  EXPECT_LT(fit.rmse, 0.025);
  EXPECT_LT(std::abs(fit.bias), 0.02);
}

TEST(Ground, FollowsTheBankUnderTheVines) {
  const auto bank = [](double x, double y) {
    const double across = std::remainder(x - 500000, 2.5) / 0.35;
    return rolling(x, y) + 0.12 * std::exp(-across * across);
  };
  Scene scene(14, bank);
  scene.add_ground({500005, 6100005}, {500045, 6100045}, 150, 0.015);
  const GroundModel model = testing::ground_of(testing::survey_all(scene.tiles()));
  double sum = 0;
  int n = 0;
  for (double x = 500015; x < 500036; x += 2.5)  // along the crests
    for (double y = 6100015; y < 6100036; y += 0.3) {
      const double e = model.height(x, y).value() - bank(x, y);
      sum += e * e, ++n;
    }
  EXPECT_LT(std::sqrt(sum / n), 0.03);  // the bare hull passes 0.10 below
}

TEST(Ground, HasNoSeamsBetweenTiles) {
  Scene scene(15, rolling);
  scene.add_ground({500005, 6100005}, {500045, 6100045}, 120, 0.02);
  const GroundModel model = testing::ground_of(testing::survey_all(scene.tiles()));
  const auto& west = model.tiles().at({20000, 244000});
  const auto& east = model.tiles().at({20001, 244000});
  ASSERT_EQ(west.nx, 101);
  int compared = 0;
  for (int iy = 30; iy < west.ny; ++iy) {
    ASSERT_TRUE(std::isfinite(west.at(100, iy)));
    EXPECT_NEAR(west.at(100, iy), east.at(0, iy), 1e-3);
    ++compared;
  }
  EXPECT_EQ(compared, 71);
}

TEST(Ground, IsUnknownWhereNothingWasSeen) {
  Scene scene(16);
  scene.add_ground({500001, 6100001}, {500010, 6100024}, 100, 0.01);
  scene.add_ground({500018, 6100001}, {500024, 6100024}, 100, 0.01);
  const GroundModel model = testing::ground_of(testing::survey_all(scene.tiles()));
  EXPECT_TRUE(model.height(500011, 6100010));   // within two metres of hits
  EXPECT_FALSE(model.height(500014, 6100010));  // in the middle of the gap
  EXPECT_FALSE(model.height(500030, 6100010));  // no tile
  EXPECT_FALSE(model.height(NAN, 6100010));
}

TEST(Ground, OfTooFewPointsIsUnknownWithAReason) {
  Scene empty(17), line(18);
  empty.add_point({500010, 6100010, 100});
  for (int i = 0; i < 2000; ++i) line.add_point({500002 + 0.01 * i, 6100010.1, 100});
  for (const Scene* scene : {&empty, &line}) {
    const auto surveys = testing::survey_all(scene->tiles());
    const auto ground = estimate_ground(surveys.front().index, testing::pointers(surveys), {});
    ASSERT_TRUE(ground);
    EXPECT_EQ(ground->known_nodes, 0);
    EXPECT_FALSE(ground->unknown_reason.empty());
    for (float z : ground->nodes.values) EXPECT_TRUE(std::isnan(z));
  }
}

TEST(Ground, SurvivesStorageWithItsUnknownNodes) {
  Scene scene(19);
  scene.add_ground({500001, 6100001}, {500012, 6100024}, 100, 0.01);
  const auto surveys = testing::survey_all(scene.tiles());
  const auto ground = estimate_ground(surveys.front().index, testing::pointers(surveys), {});
  ASSERT_TRUE(ground);
  const auto back = ground_from_arrays(ground_to_arrays(surveys.front().index, *ground));
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->first, surveys.front().index);
  EXPECT_EQ(back->second.known_nodes, ground->known_nodes);
  ASSERT_EQ(back->second.nodes.values.size(), ground->nodes.values.size());
  for (std::size_t i = 0; i < ground->nodes.values.size(); ++i) {
    const float a = ground->nodes.values[i], b = back->second.nodes.values[i];
    EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b)));
  }
  tile::ArraySet wrong = ground_to_arrays(surveys.front().index, *ground);
  std::get<std::vector<float>>(wrong.columns["height_m"]).resize(7);
  EXPECT_EQ(ground_from_arrays(wrong).error().code, ErrorCode::damaged);
}

}  // namespace
}  // namespace rayfield::density
