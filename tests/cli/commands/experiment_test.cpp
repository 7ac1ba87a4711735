#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

void expect_refused(const Outcome& run, const std::string& why) {
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_EQ(run.error_lines(), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr(why));
}

json run_json(const std::vector<std::string>& arguments) {
  std::vector<std::string> all{"experiment", "--json"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  const Outcome run = rayfield(all);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return json::parse(run.out);
}

TEST(Experiment, WrongNamesAndNumbersAreRefusedInOneLine) {
  expect_refused(rayfield({"experiment"}), "NAME");
  expect_refused(rayfield({"experiment", "frobnicate"}), "turbid");
  expect_refused(rayfield({"experiment", "turbid", "--trials", "0"}), "trials");
  expect_refused(rayfield({"experiment", "beam", "--trials", "many"}), "trials");
  expect_refused(rayfield({"experiment", "turbid", "--seed", "-1"}), "seed");
  expect_refused(rayfield({"experiment", "spinning", "--trials", "-5"}), "trials");
}

TEST(Experiment, TurbidHasEveryEstimatorWithErrorsAndTheExactValueBeside) {
  const json report = run_json({"turbid", "--trials", "200"});
  ASSERT_EQ(report["cells"].size(), 30U);
  for (const json& cell : report["cells"]) {
    for (const char* estimator : {"naive", "maximum_likelihood", "mode", "debiased", "unbiased"}) {
      EXPECT_TRUE(cell[estimator]["value"].is_number()) << estimator;
      if (cell["optical_depth"] <= 1) {  // deeper, all rays may hit in all trials
        EXPECT_GT(cell[estimator]["standard_error"], 0) << estimator;
      }
    }
    EXPECT_NEAR(cell["unbiased"]["exact"].get<double>(), 0, 1e-6);
  }
  EXPECT_TRUE(report["uncensored"][0]["paper_deviation"].is_null()) << "infinite for two rays";
  EXPECT_FALSE(report["notes"].empty());
}

TEST(Experiment, TablesHoldThePapersFigures) {
  const Outcome spinning = rayfield({"experiment", "spinning", "--trials", "20", "--progress", "none"});
  ASSERT_EQ(spinning.exit_code, 0) << spinning.err;
  for (const char* figure : {"+67.9", "+45.5", "−44.6", "−1.1", "−68.5", "+3.7", "+2.6"})
    EXPECT_THAT(spinning.out, HasSubstr(figure));
  const json triangles = run_json({"triangles", "--trials", "20"});
  EXPECT_EQ(triangles["paper"]["largest_error"], 0.08);
  EXPECT_EQ(triangles["few_rays"].size(), 6U * 13U);
  EXPECT_EQ(triangles["surface"].size(), 4U * 7U);
}

TEST(Experiment, IsTheSameForASeedAtAnyNumberOfThreads) {
  const std::vector<std::string> base{"spinning", "--trials", "100", "--seed", "5", "--threads"};
  std::vector<std::string> one = base, three = base, other = base;
  one.emplace_back("1"), three.emplace_back("3"), other.emplace_back("1");
  other[4] = "6";
  const json first = run_json(one);
  EXPECT_EQ(first, run_json(three));
  EXPECT_NE(first["rows"], run_json(other)["rows"]);
}

TEST(Experiment, WritesChartsIntoTheFolderAndNotOverThose) {
  const Folder folder;
  const std::string out = folder.path("charts");
  const json report = run_json({"triangles", "--trials", "20", "-o", out});
  ASSERT_EQ(report["files"].size(), 4U);
  for (const json& file : report["files"]) EXPECT_GT(std::filesystem::file_size(file.get<std::string>()), 1000U);
  expect_refused(rayfield({"experiment", "triangles", "--trials", "20", "-o", out}), "there already");
  run_json({"triangles", "--trials", "20", "-o", out, "--overwrite"});
  write_file(folder.path("file"), "");
  EXPECT_NE(rayfield({"experiment", "turbid", "--trials", "20", "-o", folder.path("file")}).exit_code, 0);
}

TEST(Experiment, ADryRunDoesNothing) {
  const Folder folder;
  const json report = run_json({"beam", "--dry-run", "-o", folder.path("charts")});
  EXPECT_EQ(report["dry_run"], true);
  EXPECT_FALSE(std::filesystem::exists(folder.path("charts")));
}

}  // namespace
}  // namespace rayfield::test
