#include "libdensity/pipeline/processed_scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/libdensity/simulated_block.h"

namespace rayfield::density {
namespace {

using testing::Block;
using ::testing::Contains;
using testing::drive_with;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double kHalf = 0.5;
constexpr std::uint64_t kFirst = 1, kSecond = 2;

// Remembers what was worked at.
class Stages : public Progress {
 public:
  void stage(std::string_view name, std::uint64_t, std::string_view) override { names.emplace_back(name); }
  std::vector<std::string> names;
};

struct Processed {
  ProcessReport report;
  std::vector<std::string> stages;
};

Processed run_over(Block& block, const ProcessOptions& options = {}) {
  Stages stages;
  const ProcessReport report = testing::take(process(block.store(), options, "test", stages));
  return {report, stages.names};
}

TEST(ProcessedScan, IsNotLookedAtAgainWhenAnotherDateComes) {
  Block block;
  block.add("2019-08-01", drive_with(0, kSecond));
  const Processed first = run_over(block);
  EXPECT_THAT(first.stages, Contains(StartsWith("2019-08-01")));
  const auto files = block.derived("2019-08-01");

  block.add("2019-11-20", drive_with(kHalf, kFirst));
  const Processed second = run_over(block);
  EXPECT_THAT(second.stages, Contains(StartsWith("2019-11-20")));
  EXPECT_THAT(second.stages, Not(Contains(StartsWith("2019-08-01"))));
  EXPECT_EQ(second.report.scans[0].files_made, 0U);
  EXPECT_EQ(block.derived("2019-08-01"), files);

  // What is said of it is what was said when it was made.
  const ScanReport &then = second.report.scans[1], now = run_over(block).report.scans[1];
  EXPECT_EQ(now.files_made, 0U);
  EXPECT_EQ(now.files_kept, then.files_made + then.files_kept);
  EXPECT_EQ(now.rays, then.rays);
  EXPECT_EQ(now.plant_area_m2, then.plant_area_m2);
  EXPECT_EQ(now.leaf_area_m2, then.leaf_area_m2);
  EXPECT_EQ(now.leaf_size_m2, then.leaf_size_m2);
  EXPECT_EQ(now.voxel_m, then.voxel_m);
  EXPECT_EQ(now.wood_scan_id, then.wood_scan_id);
  EXPECT_EQ(now.notes, then.notes);
}

TEST(ProcessedScan, IsLookedAtAgainWhereOptionsOrFilesAreOthers) {
  Block block;
  block.add("2019-11-20", drive_with(kHalf, kFirst));
  run_over(block);
  const auto files = block.derived("2019-11-20");

  ProcessOptions coarse;
  coarse.plan.cell_m = 0.2;
  EXPECT_GT(run_over(block, coarse).report.scans[0].files_made, 0U);
  EXPECT_NE(block.derived("2019-11-20"), files);
  run_over(block);
  EXPECT_EQ(block.derived("2019-11-20"), files);

  const std::filesystem::path damaged = block.store().folder() / files.at("results/block");
  std::ofstream(damaged, std::ios::binary | std::ios::app) << "x";
  EXPECT_EQ(run_over(block).report.scans[0].files_made, 1U);
  std::filesystem::remove(damaged);
  EXPECT_EQ(run_over(block).report.scans[0].files_made, 1U);
  EXPECT_EQ(block.derived("2019-11-20"), files);
}

// One lane between two rows.
TEST(ProcessedScan, WhatIsSeenFromOneSideIsSaidAgain) {
  sim::Site site = testing::block_site(1, kFirst);
  site.dates[0].lanes = {1};
  Block block;
  block.add("2020-01-20", testing::drive_past(site));
  const auto said = ::testing::Contains(::testing::HasSubstr("driven past on one side only"));
  EXPECT_THAT(run_over(block).report.scans[0].notes, said);
  const ScanReport again = run_over(block).report.scans[0];
  EXPECT_EQ(again.files_made, 0U);
  EXPECT_THAT(again.notes, said);
}

}  // namespace
}  // namespace rayfield::density
