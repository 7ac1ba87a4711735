#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using testing::HasSubstr;

TEST(Options, TheDocumentationListsThemAsTheProgramHasThem) {
  const Outcome run = rayfield({"options"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string page = read_file(std::string(RAYFIELD_DOCS) + "/options.md");
  EXPECT_THAT(page, HasSubstr(run.out)) << "put the output of `rayfield options` into docs/options.md";
}

TEST(Options, JsonNamesKeyDefaultRangeAndMeaningOfEach) {
  const Outcome run = rayfield({"options", "process", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto fields = nlohmann::json::parse(run.out);
  EXPECT_FALSE(fields.contains("slam"));
  for (const auto& field : fields["process"]) {
    EXPECT_FALSE(field["meaning"].get<std::string>().empty()) << field;
    EXPECT_FALSE(field["range"].get<std::string>().empty()) << field;
  }
}

class Settings : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(rayfield({"init", store(), "--crs", "EPSG:32632"}).exit_code, 0); }
  std::string store() const { return folder_.path("block"); }
  void expect_refused(const std::vector<std::string>& more, const std::string& key, const std::string& why) const {
    std::vector<std::string> arguments{"process", store()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = rayfield(arguments);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(key));
    EXPECT_THAT(run.err, HasSubstr(why));
  }
  Folder folder_;
};

TEST_F(Settings, WrongKeysKindsAndRangesAreRefusedWithTheKey) {
  expect_refused({"--set", "posts.min_contrast=100"}, "posts.min_contrast", "outside");
  expect_refused({"--set", "posts.min_contrast=high"}, "posts.min_contrast", "number");
  expect_refused({"--set", "posts.contrast=2"}, "posts.contrast", "no such option");
  expect_refused({"--set", "posts.min_contrast"}, "posts.min_contrast", "KEY=VALUE");
  expect_refused({"--set", "estimator.estimator=best"}, "estimator.estimator", "unbiased, paper");
}

TEST_F(Settings, FlagsThatStandForAnOptionRefuseWhatItRefuses) {
  expect_refused({"--panel-length", "0.1"}, "--panel-length", "0.1 is outside");
  expect_refused({"--estimator", "best"}, "--estimator", "unbiased, paper");
  expect_refused({"--leaf-area", "large"}, "--leaf-area", "number");
}

TEST_F(Settings, WrongValuesInAConfigurationFileAreNamedWithFileAndLine) {
  const std::vector<std::array<std::string, 3>> cases = {
      {"[process.posts]\nmin_contrast = 100.0\n", "c.toml:2: 'posts.min_contrast'", "outside"},
      {"\n[process.posts]\n\nmin_contrast = \"high\"\n", "c.toml:4: 'posts.min_contrast'", "number"},
      {"[process.pots]\nmin_contrast = 2.5\n", "c.toml:2: 'pots.min_contrast'", "no such option"},
      {"[process.voxels.leaf_angles]\ntype = \"flat\"\n", "c.toml:2: 'voxels.leaf_angles.type'", "planophile"},
      {"quiet = true\nthreads = 0\n", "c.toml:2: 'threads'", "0"},
      {"[process]\n\npanel-length = \"long\"\n", "c.toml:3: 'panel-length'", "number"},
      {"[process]\nmemory = \"much\"\n", "c.toml:2: 'memory'", "not an amount of memory"},
      {"[process]\nvoxel-size = 0.1\nraster-cell = 99\n", "c.toml:3: 'raster-cell'", "outside"}};
  for (const auto& [text, place, why] : cases) {
    SCOPED_TRACE(text);
    write_file(folder_.path("c.toml"), text);
    expect_refused({"--config", folder_.path("c.toml")}, place, why);
  }
}

TEST_F(Settings, AWrongValueOfTheCommandLineIsNotBlamedOnTheConfigurationFile) {
  write_file(folder_.path("c.toml"), "[process]\npanel-length = 7.5\n[process.posts]\nmin_contrast = 2.5\n");
  for (const char* wrong : {"--set=posts.min_contrast=100", "--panel-length=0.1"}) {
    const Outcome run = rayfield({"process", store(), "--config", folder_.path("c.toml"), wrong});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, testing::Not(HasSubstr("c.toml")));
  }
}

TEST_F(Settings, TablesBelowTheCommandsInAConfigurationFileAreTheSameAndTheCommandLineWins) {
  write_file(folder_.path("bad.toml"), "[process.posts]\nmin_contrast = 100.0\n");
  expect_refused({"--config", folder_.path("bad.toml")}, "posts.min_contrast", "outside");
  // The store is empty: what is not refused for its options is refused for that.
  write_file(folder_.path("good.toml"),
             "[process.posts]\nmin_contrast = 2.5\n[process.voxels.leaf_angles]\ntype = \"uniform\"\n");
  expect_refused({"--config", folder_.path("good.toml")}, "block", "no scan");
  expect_refused({"--config", folder_.path("good.toml"), "--set", "posts.min_contrast=100"}, "posts.min_contrast",
                 "outside");
  write_file(folder_.path("none.toml"), "[process.pots]\nmin_contrast = 2.5\n");
  expect_refused({"--config", folder_.path("none.toml")}, "pots.min_contrast", "no such option");
}

}  // namespace
}  // namespace rayfield::test
