#include <fmt/core.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::uint64_t bytes_in(const fs::path& folder) {
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) bytes += entry.file_size();
  return bytes;
}

// What a command says that it needs, what it then adds to a folder, and what it had resident.
struct Measured {
  json plan;
  std::uint64_t disk = 0, memory = 0;
};

Measured run(std::vector<std::string> arguments, const fs::path& folder) {
  Measured measured;
  arguments.insert(arguments.end(), {"-q", "--threads", "2"});
  const std::uint64_t before = fs::exists(folder) ? bytes_in(folder) : 0;
  std::vector<std::string> dry = arguments;
  dry.insert(dry.end(), {"--dry-run", "--json"});
  const Outcome planned = rayfield(dry);
  EXPECT_EQ(planned.exit_code, 0) << planned.err;
  measured.plan = json::parse(planned.out);
  EXPECT_EQ(fs::exists(folder) ? bytes_in(folder) : 0, before) << "a dry run writes nothing";
  const Outcome done = rayfield(arguments);
  EXPECT_EQ(done.exit_code, 0) << done.err;
  measured.disk = bytes_in(folder) - before;
  measured.memory = done.peak_bytes;
  return measured;
}

// docs/commands.md, "Dry runs".
void expect_within(const Measured& measured, double factor, const std::string& command) {
  const double ratio = measured.plan["disk_bytes"].get<double>() / static_cast<double>(measured.disk);
  fmt::print("{}: {} B of disk, {:.2f} of them said; {} MiB resident\n", command, measured.disk, ratio,
             measured.memory >> 20U);
  EXPECT_LT(ratio, factor) << command;
  EXPECT_GT(ratio, 1 / factor) << command;
  EXPECT_GE(measured.plan["memory_bytes"].get<std::uint64_t>(), measured.memory) << command;
  EXPECT_GT(measured.plan["free_bytes"].get<std::uint64_t>(), 0U);
}

TEST(DryRun, SaysTheDiskAndMemoryThatARunThenTakes) {
  const Folder work;
  const std::string site = small_site(work), logs = work.path("logs"), store = work.path("block"),
                    maps = work.path("maps"), cloud = work.path("clouds/scan.ply");
  expect_within(run({"simulate", site, "-o", logs}, logs), 1.5, "simulate");
  const std::string early = logs + "/2021-05-01", late = logs + "/2021-07-01";
  const std::string crs =
      json::parse(rayfield({"simulate", site, "-o", work.path("x"), "--dry-run", "--json"}).out)["crs"];
  fs::create_directory(work.path("clouds"));
  const auto slam = run({"slam", late + "/scan.bag", "--rig", late + "/rig.toml", "-o", cloud}, work.path("clouds"));
  expect_within(slam, 1.5, "slam");
  ASSERT_EQ(rayfield({"init", store, "--crs", crs}).exit_code, 0);
  const auto add = [&](const std::string& date) {
    return run({"add", store, logs + "/" + date + "/rays.ply", "--date", date, "--memory", "1G"}, store);
  };
  expect_within(add("2021-05-01"), 1.5, "add, the first");
  expect_within(run({"process", store, "--memory", "1G"}, store), 3, "process, the first");
  expect_within(add("2021-07-01"), 1.5, "add, the second");
  const Measured second = run({"process", store, "--memory", "1G"}, store);
  EXPECT_EQ(second.plan["to_process"], json::array({"2021-07-01"}));
  expect_within(second, 2, "process, the second");
  expect_within(run({"export", store, "-o", maps, "--format", "geotiff,gpkg,png,geojson,csv"}, maps), 2, "export");
}

TEST(DryRun, SaysWhereNothingIsToBeDone) {
  const Folder work;
  const std::string site = small_site(work, kEarlyDate), store = work.path("block");
  ASSERT_EQ(rayfield({"simulate", site, "-o", work.path("logs"), "--no-log", "-q"}).exit_code, 0);
  const std::string cloud = work.path("logs/2021-05-01/rays.ply");
  const std::string crs =
      json::parse(rayfield({"simulate", site, "-o", work.path("x"), "--dry-run", "--json"}).out)["crs"];
  const std::vector<std::string> update{"update", store, cloud, "--date", "2021-05-01", "--crs", crs};
  auto dry = update;
  dry.insert(dry.end(), {"--dry-run", "--json"});
  const json before = json::parse(rayfield(dry).out);
  EXPECT_EQ(before["already_there"], false);
  EXPECT_GT(before["disk_bytes"].get<std::uint64_t>(), fs::file_size(cloud) / 20);
  ASSERT_EQ(rayfield(update).exit_code, 0);
  const json after = json::parse(rayfield(dry).out);
  EXPECT_EQ(after["already_there"], true);
  EXPECT_EQ(after["to_process"], json::array());
  EXPECT_EQ(after["disk_bytes"], 0);
  const Outcome process = rayfield({"process", store});
  EXPECT_EQ(process.out, "Nothing to process: 2021-05-01 as it was\n");
  EXPECT_EQ(process.err, "") << "files that are taken as they are need no line of progress";
  EXPECT_NE(rayfield({"process", store, "-v"}).out.find("plant area"), std::string::npos);
  EXPECT_EQ(json::parse(rayfield({"process", store, "--overwrite", "--dry-run", "--json"}).out)["to_process"].size(),
            1U);
}

}  // namespace
}  // namespace rayfield::test
