#include "rayfield/sim/truth.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "rayfield/core/map_frame.h"
#include "tests/sim/sim_test_sites.h"

namespace rayfield::sim {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  EXPECT_TRUE(in) << path;
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

class TruthFiles : public ::testing::Test {
 protected:
  TruthFiles() : world(make_world(small_site())), drive(take(plan_drive(world))), result(take(truth(world, drive))) {}
  World world;
  Drive drive;
  Truth result;
};

TEST_F(TruthFiles, HoldEveryRowPanelMetreAndPost) {
  EXPECT_EQ(result.rows.size(), 2U);
  EXPECT_EQ(result.panels.size(), 4U);
  EXPECT_EQ(result.metres.size(), 52U);
  EXPECT_EQ(result.posts.size(), 6U);
  double panels = 0, metres = 0;
  for (const Truth::Panel& panel : result.panels) panels += panel.leaf_area_m2 + panel.wood_area_m2;
  for (const Truth::Metre& metre : result.metres) metres += 0.5 * (metre.leaf_area_per_m + metre.wood_area_per_m);
  EXPECT_NEAR(panels, metres, 1e-9);
  EXPECT_NEAR(panels, result.leaf_area_m2 + result.wood_area_m2, 1e-9);
}

TEST_F(TruthFiles, PostsStandAtPanelEndsOnTheGround) {
  for (const Truth::Panel& panel : result.panels) {
    const Post& post = result.posts[static_cast<std::size_t>(panel.row * 3 + panel.panel)];
    EXPECT_NEAR((post.position - panel.from).norm(), 0, 1e-9);
    EXPECT_NEAR(post.ground_m, world.terrain().height(post.position), 1e-9);
  }
}

TEST_F(TruthFiles, MapTrajectoryIsTheLocalOneThroughTheProjectionWithItsConvergence) {
  const Site& site = result.site;
  const MapFrame frame = take(MapFrame::create("EPSG:7854"));
  const TangentPlane plane({site.latitude_deg, site.longitude_deg, site.height_m});
  for (std::size_t i = 0; i < result.trajectory.size(); i += 500) {
    const Rigid3 &local = result.trajectory[i].map_from_body, &map = result.trajectory_in_map[i].map_from_body;
    const Eigen::Vector3d expected = frame.map_from_geodetic(plane.geodetic_from_enu(local.translation));
    EXPECT_NEAR((map.translation - expected).norm(), 0, 1e-4);
    // Grid north lies the convergence clockwise of true north: azimuths on the grid are smaller by it.
    const Eigen::Vector3d a = local.rotation * Eigen::Vector3d::UnitX(), b = map.rotation * Eigen::Vector3d::UnitX();
    const double turn = std::remainder(std::atan2(b.x(), b.y()) - std::atan2(a.x(), a.y()), 2 * std::numbers::pi);
    EXPECT_NEAR(turn, -frame.convergence_rad(map.translation), 1e-6);
  }
}

TEST_F(TruthFiles, AreWrittenInTheDocumentedFormats) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "sim_truth" / "nested";
  const auto written = write_truth(result, folder);
  ASSERT_TRUE(written) << written.error().line();
  const auto trajectory = lines_of(folder / "trajectory.tum");
  EXPECT_EQ(trajectory.size(), result.trajectory.size() + 1);
  EXPECT_THAT(trajectory[0], StartsWith("# local east-north-up"));
  EXPECT_THAT(trajectory[0], HasSubstr("IMU frame"));
  EXPECT_THAT(lines_of(folder / "trajectory_map.tum")[0], HasSubstr("EPSG:7854"));
  const auto panels = lines_of(folder / "panels.csv");
  ASSERT_EQ(panels.size(), 5U);
  EXPECT_EQ(panels[0], "row,panel,e0,n0,e1,n1,length_m,leaf_area_m2,leaf_area_per_m,wood_area_m2");
  std::istringstream fields(panels[2]);
  std::vector<double> values;
  for (std::string field; std::getline(fields, field, ',');) values.push_back(std::stod(field));
  ASSERT_EQ(values.size(), 10U);
  EXPECT_EQ(values[1], 1);
  EXPECT_NEAR(values[7], result.panels[1].leaf_area_m2, 1e-6);
  EXPECT_NEAR(values[8], result.panels[1].leaf_area_m2 / 6.5, 1e-6);
  EXPECT_EQ(lines_of(folder / "metres.csv").size(), 53U);
  EXPECT_EQ(lines_of(folder / "rows.csv").size(), 3U);
  EXPECT_EQ(lines_of(folder / "posts.csv").size(), 7U);
  EXPECT_EQ(lines_of(folder / "ground.csv").size(), result.ground.size() + 1);
  EXPECT_THAT(lines_of(folder / "site.json")[0], HasSubstr("\"epsg\":7854"));
}

TEST_F(TruthFiles, CannotBeWrittenWhereAFileIsInTheWay) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "sim_truth_file";
  std::ofstream(file) << "x";
  const auto written = write_truth(result, file / "folder");
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().where, HasSubstr("sim_truth_file"));
}

}  // namespace
}  // namespace rayfield::sim
