#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/cli/lane_cloud.h"
#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

using testing::HasSubstr;

// Expects a refusal with that exit code and exactly one line that says `why`.
void expect_refused(const Outcome& run, int exit_code, const std::string& why) {
  EXPECT_EQ(run.exit_code, exit_code) << run.err;
  EXPECT_EQ(run.error_lines(), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr(why));
}

class CommandLine : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(rayfield({"init", store(), "--crs", "EPSG:32632"}).exit_code, 0); }
  std::string store() const { return folder_.path("block"); }
  std::string put(const std::string& name, const std::string& content) const {
    write_file(folder_.path(name), content);
    return folder_.path(name);
  }
  Folder folder_;
};

TEST_F(CommandLine, EveryCommandHasHelpWithAnExample) {
  for (const char* verb :
       {"demo", "simulate", "init", "add", "process", "export", "update", "compare", "report", "info", "status", "log",
        "remove", "revert", "registry", "verify", "repair", "gc", "experiment"}) {
    const Outcome run = rayfield({verb, "--help"});
    EXPECT_EQ(run.exit_code, 0) << verb;
    EXPECT_THAT(run.out, HasSubstr(std::string("rayfield ") + verb)) << verb;
    EXPECT_THAT(run.out, HasSubstr("Example")) << verb;
  }
}

TEST_F(CommandLine, WrongUsageEndsWithTwo) {
  expect_refused(rayfield({}), 2, "no command");
  expect_refused(rayfield({"frobnicate"}), 2, "no such command");
  expect_refused(rayfield({"add", store()}), 2, "CLOUD");
  expect_refused(rayfield({"process", store(), "--threads", "none"}), 2, "threads");
  expect_refused(rayfield({"process", store(), "--memory", "lots"}), 2, "lots");
  expect_refused(rayfield({"add", store(), "x.ply", "--date", "2019-02-30"}), 2, "calendar");
}

TEST_F(CommandLine, AWrongValueIsAnsweredWithTheValuesThatAreTaken) {
  expect_refused(rayfield({"status", store(), "--progress", "foo"}), 2, "--progress: foo not in {bar,json,none,plain}");
  expect_refused(rayfield({"status", store(), "--progress", "1"}), 2, "--progress: 1 not in");
  EXPECT_EQ(rayfield({"status", store(), "--progress", "JSON"}).exit_code, 0);
  for (const std::string number : {"-1", "foo", "1.5", "99999999999999999999"}) {
    const std::string why = ": " + number + " is no snapshot's number";
    expect_refused(rayfield({"revert", store(), number}), 2, "SNAPSHOT" + why);
    expect_refused(rayfield({"export", store(), "-o", folder_.path("o"), "--snapshot", number}), 2, "--snapshot" + why);
  }
  expect_refused(rayfield({"revert", store(), "7"}), 2, "unknown snapshot: 7");
  expect_refused(rayfield({"init", folder_.path("g"), "--crs", "EPSG:32632", "--tile-size", "wide"}), 2,
                 "--tile-size: wide is not a number");
  expect_refused(rayfield({"init", folder_.path("g"), "--crs", "foo"}), 2, "foo: PROJ does not know it");
}

// Of a short text the last bytes fail, of a long one those before.
TEST_F(CommandLine, WhatCannotBePrintedIsNoSuccess) {
  for (const std::vector<std::string>& command : {std::vector<std::string>{"--help"},
                                                  {"--version"},
                                                  {"process", "--help"},
                                                  {"help"},
                                                  {"help", "process"},
                                                  {"completion", "bash"},
                                                  {"options"},
                                                  {"status", store()},
                                                  {"status", store(), "--json"},
                                                  {"log", store()},
                                                  {"verify", store()}}) {
    const Outcome run = rayfield_printing_to("/dev/full", command);
    expect_refused(run, 5, "cannot write the result: stdout: No space left on device");
    EXPECT_EQ(rayfield_printing_to("/dev/null", command).exit_code, 0) << command[0];
  }
}

TEST_F(CommandLine, AMistypedNameIsAnsweredWithWhatWasMeant) {
  expect_refused(rayfield({"proces", store()}), 2, "did you mean process?");
  expect_refused(rayfield({"process", store(), "--thread", "4"}), 2, "did you mean --threads?");
  expect_refused(rayfield({"process", "--voxel_size=0.1", store()}), 2, "did you mean --voxel-size?");
  expect_refused(rayfield({"add", store(), "a.ply", "--no-aling", "--date", "2021-05-01"}), 2, "--no-align?");
  expect_refused(rayfield({"process", store(), "-x"}), 2, "no such option: -x");
  expect_refused(rayfield({"process", store(), "--set", "posts.min_contrats=2"}), 2, "posts.min_contrast?");
  expect_refused(rayfield({"--json", "status", store()}), 2, "behind the command");
  const auto refuse = [&](const std::string& text, const std::string& meant) {
    expect_refused(rayfield({"process", store(), "--config", put("typo.toml", text)}), 2, meant);
  };
  refuse("thread = 2\n", "did you mean threads?");
  refuse("[proces]\nthreads = 2\n", "did you mean process?");
  refuse("[process.posts]\nmin_contrst = 2\n", "did you mean posts.min_contrast?");
}

TEST_F(CommandLine, HelpOfACommandIsThatOfItsOption) {
  EXPECT_EQ(rayfield({"help", "process"}).out, rayfield({"process", "--help"}).out);
  EXPECT_EQ(rayfield({"help"}).out, rayfield({"--help"}).out);
  expect_refused(rayfield({"help", "proces"}), 2, "did you mean process?");
  EXPECT_EQ(rayfield({"-V"}).out, rayfield({"--version"}).out);
  EXPECT_THAT(rayfield({"-V"}).out, testing::StartsWith("rayfield "));
}

TEST_F(CommandLine, NamesOfFormatsMayBeWrittenInAnyCase) {
  expect_refused(rayfield({"export", store(), "-o", folder_.path("maps"), "--format", "GPKG,GeoTIFF"}), 2,
                 "not been processed");
  expect_refused(rayfield({"export", store(), "-o", folder_.path("maps"), "--format", "docx"}), 2, "docx");
}

TEST_F(CommandLine, RefusesCoordinateSystemsThatMapsCannotBeMadeIn) {
  expect_refused(rayfield({"init", folder_.path("g"), "--crs", "EPSG:4326"}), 2, "geographic");
  expect_refused(rayfield({"init", folder_.path("g"), "--crs", "EPSG:999999"}), 2, "not know");
  // Web Mercator stretches metres by 1/cos(latitude): 44.5 m² of leaves become 55.5 m² at 27°.
  expect_refused(rayfield({"init", folder_.path("g"), "--crs", "EPSG:3857"}), 2, "areas would be wrong");
  expect_refused(rayfield({"init", folder_.path("g"), "--crs", "EPSG:2225"}), 2, "metres");
  EXPECT_FALSE(std::filesystem::exists(folder_.path("g")));
}

TEST_F(CommandLine, ACoordinateSystemMayBeWrittenInSeveralWays) {
  const std::string store = folder_.path("g");
  ASSERT_EQ(rayfield({"init", store, "--crs", " epsg:32632 "}).exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(rayfield({"status", store, "--json"}).out)["crs"], "EPSG:32632");
  std::string cloud = lane_cloud(20);
  cloud.insert(cloud.find("element"), "comment crs epsg:32632\n");
  const Outcome add = rayfield({"add", store, put("a.ply", cloud), "--date", "2020-09-13", "-q"});
  EXPECT_EQ(add.exit_code, 0) << add.err;
}

TEST_F(CommandLine, WhatIsNoFileIsRefusedWithoutWaitingForIt) {
  const std::string pipe = folder_.path("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const std::string cloud = put("a.ply", lane_cloud(20));
  for (const std::string& path : {pipe, std::string("/dev/zero")}) {
    expect_refused(rayfield({"add", store(), path, "--date", "2021-05-01"}), 3, "not a regular file");
    expect_refused(rayfield({"add", store(), cloud, "--rig", path, "--date", "2021-05-01"}), 3, "not a regular file");
    expect_refused(rayfield({"info", path}), 3, "not a regular file");
    expect_refused(rayfield({"simulate", path, "-o", folder_.path("o")}), 3, "not a regular file");
  }
  for (const char* name : {"snapshots/00000001.json", "store.json"}) {
    std::filesystem::remove(store() + "/" + name);
    ASSERT_EQ(::mkfifo((store() + "/" + name).c_str(), 0600), 0);
    expect_refused(rayfield({"status", store()}), 4, name);
  }
}

TEST_F(CommandLine, AnInterruptIsHeardWhileInputsAreHashed) {
  const std::string path = put("huge.ply", "ply\n");
  std::filesystem::resize_file(path, std::uint64_t{1} << 40);  // sparse: an hour of hashing
  expect_refused(rayfield_interrupted_after({"add", store(), path, "--date", "2021-05-01"}, 1500), 130, "interrupted");
}

// The kernel answers EIO to whoever reads the start of its own memory.
TEST_F(CommandLine, ADiskThatCannotBeReadIsAMatterOfResources) {
  expect_refused(rayfield({"add", store(), "/proc/self/mem", "--date", "2021-05-01"}), 5, "Input/output error");
}

TEST_F(CommandLine, ASparseSnapshotIsRefusedBeforeItsSizeIsBelieved) {
  const std::string snapshot = store() + "/snapshots/00000001.json";
  write_file(snapshot, "");
  std::filesystem::resize_file(snapshot, std::uint64_t{1} << 40);
  expect_refused(rayfield({"status", store()}), 4, "00000001.json");
  EXPECT_EQ(rayfield({"verify", store()}).exit_code, 4);
}

TEST_F(CommandLine, RefusesToMakeAStoreWhereOneIs) {
  expect_refused(rayfield({"init", store(), "--crs", "EPSG:32633"}), 2, "already");
  expect_refused(rayfield({"init", store(), "--crs", "EPSG:32632", "--tile-size", "20"}), 2, "already");
  const std::string cloud = put("a.ply", lane_cloud(20));
  ASSERT_EQ(rayfield({"add", store(), cloud, "--date", "2021-05-01"}).exit_code, 0);
  expect_refused(rayfield({"init", store(), "--crs", "EPSG:32632"}), 2, "already");
}

// It may not have been told that it was done: killed, or with an error after the store was there.
TEST_F(CommandLine, InitThatIsRunAgainGoesOn) {
  const Outcome again = rayfield({"init", store(), "--crs", "EPSG:32632"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(rayfield({"verify", store(), "-q"}).exit_code, 0);
}

TEST_F(CommandLine, RefusesWhatIsNoRayCloudAndNamesTheReason) {
  const auto add = [&](const std::string& path) { return rayfield({"add", store(), path, "--date", "2021-05-01"}); };
  expect_refused(add(put("a.ply", "not a ply file")), 3, "not a PLY");
  expect_refused(add(put("b.ply", lane_cloud(10, "ascii"))), 3, "ASCII");
  expect_refused(add(put("c.ply", lane_cloud(10).substr(0, 500))), 3, "truncated");
  expect_refused(add(put("d.ply", lane_cloud(10) + "tail")), 3, "4 bytes follow");
  expect_refused(add(put("e.ply", lane_cloud(10, "binary_little_endian", false))), 3, "without ray starts");
  expect_refused(add(put("f.ply", lane_cloud(0))), 3, "no rays");
  expect_refused(add(folder_.path("missing.ply")), 3, "No such file");
  const auto status = nlohmann::json::parse(rayfield({"status", store(), "--json"}).out);
  EXPECT_TRUE(status["scans"].empty()) << "a refused cloud leaves nothing behind";
}

TEST_F(CommandLine, TakesWhatIsThereOfATruncatedCloudWhenAsked) {
  const std::string path = put("cut.ply", lane_cloud(10).substr(0, lane_cloud(10).size() - 100));
  const Outcome run = rayfield({"add", store(), path, "--date", "2021-05-01", "--allow-truncated", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(run.out);
  EXPECT_EQ(report["rays"], 7) << "three of ten 48-byte rays are cut";
  EXPECT_FALSE(report["warnings"].empty());
}

TEST_F(CommandLine, CountsRaysWithCoordinatesThatAreNotNumbers) {
  std::string bytes = lane_cloud(20);
  const std::size_t body = bytes.find("end_header\n") + 11;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::size_t ray : {2U, 5U, 11U}) std::memcpy(bytes.data() + body + ray * 48, &nan, sizeof(nan));
  const Outcome run = rayfield({"add", store(), put("nan.ply", bytes), "--date", "2021-05-01", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto report = nlohmann::json::parse(run.out);
  EXPECT_EQ(report["rays"], 17);
  EXPECT_THAT(report["warnings"].dump(), HasSubstr("3 rays"));
}

TEST_F(CommandLine, TheSameScanTwiceIsNothingToDoAndAnotherOneOfThatDateIsRefused) {
  const std::string first = put("first.ply", lane_cloud(50)), second = put("second.ply", lane_cloud(60));
  ASSERT_EQ(rayfield({"add", store(), first, "--date", "2021-05-01"}).exit_code, 0);
  const Outcome again = rayfield({"add", store(), first, "--date", "2021-05-01", "--json"});
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(again.out)["already_there"], true);
  expect_refused(rayfield({"add", store(), second, "--date", "2021-05-01"}), 2, "--name");
  EXPECT_EQ(rayfield({"add", store(), second, "--date", "2021-05-01", "--name", "evening", "--no-align"}).exit_code, 0);
  EXPECT_EQ(rayfield({"add", store(), second, "--date", "2021-05-01", "--overwrite", "--no-align"}).exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(rayfield({"status", store(), "--json"}).out)["scans"].size(), 2U);
}

TEST_F(CommandLine, AScanWithoutRowsEndsWithThreeAndLosesNothing) {
  ASSERT_EQ(rayfield({"add", store(), put("lane.ply", lane_cloud(3000)), "--date", "2021-05-01"}).exit_code, 0);
  expect_refused(rayfield({"process", store(), "-q"}), 3, "no rows found");
  EXPECT_EQ(rayfield({"verify", store(), "-q"}).exit_code, 0);
}

TEST_F(CommandLine, SaysWhatIsMissingBeforeAnythingWasAddedOrProcessed) {
  expect_refused(rayfield({"process", store()}), 2, "no scan");
  expect_refused(rayfield({"export", store(), "-o", folder_.path("maps")}), 2, "not been processed");
  expect_refused(rayfield({"status", folder_.path("nowhere")}), 3, "nowhere");
}

TEST_F(CommandLine, VerifyNamesTheDamagedFileAndEndsWithFour) {
  ASSERT_EQ(rayfield({"add", store(), put("a.ply", lane_cloud(5000)), "--date", "2021-05-01"}).exit_code, 0);
  EXPECT_EQ(rayfield({"verify", store()}).exit_code, 0);
  std::string damaged;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(store())) {
    if (entry.path().extension() != ".h5" || !damaged.empty()) continue;
    std::string bytes = read_file(entry.path());
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    std::filesystem::permissions(entry.path(), std::filesystem::perms::owner_write, std::filesystem::perm_options::add);
    write_file(entry.path(), bytes);
    damaged = entry.path().filename().string();
  }
  ASSERT_FALSE(damaged.empty());
  const Outcome run = rayfield({"verify", store(), "--json"});
  EXPECT_EQ(run.exit_code, 4);
  EXPECT_THAT(nlohmann::json::parse(run.out)["damaged"].dump(), HasSubstr(damaged));
  const Outcome quiet = rayfield({"verify", store(), "-q"});
  expect_refused(quiet, 4, damaged);
  EXPECT_EQ(quiet.out, "");
}

TEST_F(CommandLine, ConfigurationFilesSetOptionsAndRefuseUnknownKeys) {
  ASSERT_EQ(rayfield({"add", store(), put("a.ply", lane_cloud(50)), "--date", "2021-05-01"}).exit_code, 0);
  const std::string good = put("good.toml", "threads = 1\n[process]\nvoxel-size = -1.0\n");
  expect_refused(rayfield({"process", store(), "--config", good}), 2, "good.toml:3: 'voxel-size'");
  const std::string wins = put("wins.toml", "[process]\nvoxel-size = -1.0\n");
  const Outcome given = rayfield({"process", store(), "--config", wins, "--voxel-size", "0.12", "-q"});
  EXPECT_EQ(given.exit_code, 3) << "the command line wins, and the scan has no rows: " << given.err;
  const std::string bad = put("bad.toml", "[process]\nvoxel_sise = 0.1\n");
  const Outcome refused = rayfield({"process", store(), "--config", bad});
  expect_refused(refused, 2, "voxel_sise");
  EXPECT_THAT(refused.err, HasSubstr("bad.toml:2"));
}

TEST_F(CommandLine, OneDateOptionTakesOneValueOrAListWithCommas) {
  for (const auto& [date, rays] : {std::pair{"2021-05-01", 50}, {"2021-06-01", 60}, {"2021-07-01", 70}})
    ASSERT_EQ(
        rayfield({"add", store(), put(std::string(date) + ".ply", lane_cloud(rays)), "--date", date, "--no-align"})
            .exit_code,
        0);
  const auto chosen = [&](const std::vector<std::string>& dates) {
    std::vector<std::string> arguments{"process", "--dry-run", "--json"};
    arguments.insert(arguments.end(), dates.begin(), dates.end());
    arguments.push_back(store());
    const Outcome run = rayfield(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out)["scans"].get<std::vector<std::string>>();
  };
  const std::vector<std::string> two = {"2021-05-01", "2021-07-01"};
  EXPECT_EQ(chosen({"--date", "2021-07-01"}), std::vector<std::string>{"2021-07-01"});
  EXPECT_EQ(chosen({"--date=2021-05-01,2021-07-01"}), two);
  EXPECT_EQ(chosen({"--date", "2021-05-01", "--date", "2021-07-01"}), two);
  expect_refused(rayfield({"export", "--date", "2021-07-01", "--format", "png", store(), "-o", folder_.path("maps")}),
                 2, "not been processed");
}

TEST_F(CommandLine, JsonIsOneDocumentAlsoForErrors) {
  const Outcome good = rayfield({"status", store(), "--json"});
  EXPECT_TRUE(nlohmann::json::accept(good.out));
  const Outcome bad = rayfield({"process", store(), "--json"});
  EXPECT_EQ(nlohmann::json::parse(bad.out)["error"]["code"], 2);
}

TEST_F(CommandLine, ADryRunChangesNothing) {
  const std::string path = put("a.ply", lane_cloud(50));
  const auto before = content_of(store());
  EXPECT_EQ(rayfield({"add", store(), path, "--date", "2021-05-01", "--dry-run"}).exit_code, 0);
  EXPECT_EQ(rayfield({"init", folder_.path("other"), "--crs", "EPSG:32632", "--dry-run"}).exit_code, 0);
  EXPECT_EQ(content_of(store()), before);
  EXPECT_FALSE(std::filesystem::exists(folder_.path("other")));
}

}  // namespace
}  // namespace rayfield::test
