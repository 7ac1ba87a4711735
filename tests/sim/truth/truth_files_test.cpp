#include "rayfield/sim/truth_files.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "tests/sim/true_values.h"

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

class TruthFiles : public TrueValues {};

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
