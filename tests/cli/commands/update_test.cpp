#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/cli/program.h"

namespace rayfield::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kEarly = "2021-05-01";
constexpr const char* kLate = "2021-07-01";

// Processor time of the programs that were run so far: no less than they take on a machine of their own.
double seconds_of_children() {
  rusage usage = {};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Simulates the small site once for all tests of this program; the late date with its log.
class Update : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    logs_ = new Folder;
    const std::string site = small_site(*logs_);
    const auto simulate = [&](std::vector<std::string> arguments) {
      arguments.insert(arguments.begin(), {"simulate", site, "-o", logs_->path("logs"), "-q"});
      const Outcome run = rayfield(arguments);
      ASSERT_EQ(run.exit_code, 0) << run.err;
    };
    simulate({"--date", kEarly, "--no-log"});
    simulate({"--date", kLate});
  }
  static void TearDownTestSuite() {
    delete logs_;
    logs_ = nullptr;
  }
  static std::string cloud(const std::string& date) { return logs_->path("logs/" + date + "/rays.ply"); }
  static std::string late(const std::string& file) { return logs_->path(std::string("logs/") + kLate + "/" + file); }

  static std::vector<std::string> update(const std::string& store, const std::string& maps, const std::string& date) {
    return {"update", store, cloud(date), "--date", date, "-o", maps, "--crs", "EPSG:32632", "-q", "--json"};
  }
  static json run(const std::vector<std::string>& arguments) {
    const Outcome outcome = rayfield(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(outcome.out, nullptr, false);
  }
  static std::string metadata(const std::string& path, const char* key) {
    GDALAllRegister();
    GDALDataset* dataset = GDALDataset::Open(path.c_str());
    const char* value = dataset == nullptr ? nullptr : dataset->GetMetadataItem(key);
    std::string text = value == nullptr ? "none" : value;
    GDALClose(dataset);
    return text;
  }
  static std::string tif(const std::string& maps, const std::string& date) {
    return maps + "/block_" + date + "_plan_density.tif";
  }
  static Folder* logs_;
};
Folder* Update::logs_ = nullptr;

TEST_F(Update, DoesWhatItsStepsDoAndOnASecondDateOnlyWhatIsNew) {
  const Folder work;
  fs::create_directory(work.path("a"));
  fs::create_directory(work.path("b"));
  const std::string store = work.path("a/block"), maps = work.path("a/maps");
  const json first = run(update(store, maps, kEarly));
  EXPECT_EQ(first["already_there"], false);
  EXPECT_GT(first["files_made"], 5);
  EXPECT_EQ(first["products_written"], first["products"].size());
  const std::string old_raster = read_file(tif(maps, kEarly));
  const auto old_time = fs::last_write_time(tif(maps, kEarly));
  const json second = run(update(store, maps, kLate));
  EXPECT_LT(second["products_written"], second["products"].size());
  EXPECT_EQ(fs::last_write_time(tif(maps, kEarly)), old_time) << "the raster of the first date is kept";
  EXPECT_EQ(read_file(tif(maps, kEarly)), old_raster);
  EXPECT_EQ(metadata(tif(maps, kEarly), "snapshot"), "2");
  EXPECT_EQ(metadata(tif(maps, kLate), "snapshot"), "4");
  EXPECT_EQ(metadata(maps + "/block.gpkg", "snapshot"), "4");

  const std::string other = work.path("b/block"), other_maps = work.path("b/maps");
  run({"init", other, "--crs", "EPSG:32632", "--json"});
  for (const char* date : {kEarly, kLate}) run({"add", other, cloud(date), "--date", date, "-q", "--json"});
  run({"process", other, "-q", "--json"});
  run({"export", other, "-o", other_maps, "-q", "--json"});
  // The layout of the first date alone is another in the two histories: update has processed it, add only found it.
  const auto without_history = [](std::map<std::string, std::string> files) {
    std::erase_if(files, [](const auto& file) { return file.first.starts_with("registry/rows/"); });
    return files;
  };
  EXPECT_EQ(without_history(content_of(store)), without_history(content_of(other)))
      << "the steps one by one give the same store";
  EXPECT_EQ(run({"registry", store, "--json"})["rows"], run({"registry", other, "--json"})["rows"]);
}

TEST_F(Update, WithNothingNewTakesLessThanTwoSecondsAndWritesNothing) {
  const Folder work;
  const std::string store = work.path("block"), maps = work.path("maps");
  for (const char* date : {kEarly, kLate}) run(update(store, maps, date));
  const auto before = content_of(work.path());
  const double began = seconds_of_children();
  const json again = run(update(store, maps, kLate));
  const double seconds = seconds_of_children() - began;
  EXPECT_EQ(again["already_there"], true);
  EXPECT_EQ(again["files_made"], 0);
  EXPECT_EQ(again["products_written"], 0);
  EXPECT_GT(again["products"].size(), 10U);
  EXPECT_EQ(again["snapshot"], 4);
  EXPECT_LT(seconds, 2.0);
  EXPECT_EQ(content_of(work.path()), before);
}

TEST_F(Update, KilledAnywhereAndRunAgainItGivesTheSameBytes) {
  const Folder work;
  for (const char* name : {"calm", "rough"}) fs::create_directory(work.path(name));
  const auto command = [&](const std::string& name) {
    return update(work.path(name + "/block"), work.path(name + "/maps"), kLate);
  };
  run(command("calm"));
  int kills = 0;
  for (int passage = 1;; passage += 2 + kills) {
    const Outcome outcome = rayfield(command("rough"), {{"RAYFIELD_FAULT", "*:" + std::to_string(passage) + ":kill"}});
    if (outcome.exit_code == 0) break;
    ASSERT_EQ(outcome.exit_code, 128 + 9) << outcome.err;
    ++kills;
    if (!fs::exists(work.path("rough/block/store.json"))) continue;
    ASSERT_EQ(rayfield({"verify", work.path("rough/block"), "-q"}).exit_code, 0) << passage;
  }
  EXPECT_GT(kills, 8);
  ASSERT_EQ(rayfield({"gc", work.path("rough/block"), "-q"}).exit_code, 0);
  for (const char* part : {"/block", "/maps"})
    EXPECT_EQ(content_of(work.path(std::string("rough") + part)), content_of(work.path(std::string("calm") + part)));
}

TEST_F(Update, EightAtOnceLoseNothingAndShowNothingByHalves) {
  const Folder work;
  const std::string store = work.path("block");
  run(update(store, work.path("maps"), kEarly));
  const auto update_of = [&](int writer) {
    const std::string name = "writer" + std::to_string(writer);
    return std::vector<std::string>{"update", store, cloud(kLate), "--date",    kLate, "--name",
                                    name,     "-q",  "--json",     "--threads", "1"};
  };
  std::atomic<int> writing{8}, done{0}, refused{0};
  std::vector<std::thread> writers;
  for (int writer = 0; writer < 8; ++writer)
    writers.emplace_back([&, writer] {
      for (int attempt = 0; attempt < 200; ++attempt) {
        const Outcome outcome = rayfield(update_of(writer));
        if (outcome.exit_code == 0) {
          ++done;
          break;
        }
        EXPECT_EQ(outcome.exit_code, 6) << outcome.err;  // another writer holds the store
        EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
        ++refused;
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
      }
      --writing;
    });
  // A reader meets whole snapshots only, and scans that were there stay.
  std::size_t scans = 1;
  while (writing > 0) {
    EXPECT_EQ(rayfield({"verify", store, "-q"}).exit_code, 0);
    const std::size_t now = run({"status", store, "--json"})["scans"].size();
    EXPECT_GE(now, scans);
    scans = now;
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(done, 8);
  EXPECT_GT(refused, 0) << "they did not run at the same time";
  const json status = run({"status", store, "--json"});
  ASSERT_EQ(status["scans"].size(), 9U);
  for (const json& scan : status["scans"]) EXPECT_TRUE(scan["derived"].contains("results")) << scan["scan_id"];
  EXPECT_TRUE(fs::is_empty(store + "/tmp")) << "no scratch is left";
}

TEST_F(Update, OfALogKeepsItsReportAndTrajectoryWithTheScan) {
  const Folder work;
  const std::string store = work.path("block");
  const json report = run({"update", store, late("scan.bag"), "--rig", late("rig.toml"), "--date", kLate, "--crs",
                           "EPSG:32632", "-q", "--json"});
  EXPECT_GT(report["panels"], 0);
  const json files = run({"status", store, "--json"})["scans"][0]["files"];
  ASSERT_EQ(files.size(), 3U);
  EXPECT_EQ(files[0]["name"], "alignment.json");
  EXPECT_EQ(files[1]["name"], "slam.json");
  EXPECT_EQ(files[2]["name"], "trajectory.tum.bz2");
  const json slam = json::parse(read_file(store + "/" + files[1]["path"].get<std::string>()));
  EXPECT_EQ(slam["georeferenced"], true);
  // The kept trajectory is one that slam takes: the cloud along it is that of the scan.
  const json followed =
      run({"slam", late("scan.bag"), "--rig", late("rig.toml"), "--crs", "EPSG:32632", "--use-trajectory",
           store + "/" + files[2]["path"].get<std::string>(), "-o", work.path("cloud.ply"), "-q", "--json"});
  EXPECT_GT(followed["rays"], 0);
  const auto before = content_of(store);
  EXPECT_EQ(run({"update", store, late("scan.bag"), "--rig", late("rig.toml"), "--date", kLate, "-q",
                 "--json"})["already_there"],
            true);
  EXPECT_EQ(content_of(store), before);
  EXPECT_EQ(rayfield({"verify", store, "-q"}).exit_code, 0);
}

TEST_F(Update, AnExportIsOfTheSnapshotThatIsAskedFor) {
  const Folder work;
  const std::string store = work.path("block");
  run(update(store, work.path("one"), kEarly));
  run(update(store, work.path("both"), kLate));
  const json old = run({"export", store, "-o", work.path("old"), "--snapshot", "2", "-q", "--json"});
  EXPECT_EQ(old["snapshot"], 2);
  EXPECT_EQ(content_of(work.path("old")), content_of(work.path("one"))) << "as if the second date had never come";
  run({"remove", store, kLate, "-q", "--json"});
  run({"export", store, "-o", work.path("both"), "-q", "--json"});
  EXPECT_EQ(metadata(work.path("both/block.gpkg"), "snapshot"), "5") << "a scan that was removed is not protected";
}

TEST_F(Update, AGeoPackageIsNotReplacedByOneWithLessInItUnlessAsked) {
  const Folder work;
  const std::string store = work.path("block"), maps = work.path("maps");
  for (const char* date : {kEarly, kLate}) run(update(store, maps, date));
  const auto before = content_of(maps);
  const std::vector<std::string> one_date{"export", store, "-o", maps, "--date", kLate};
  const Outcome refused = rayfield(one_date);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.error_lines(), 1);
  EXPECT_THAT(refused.err, HasSubstr(std::string("leaves out: ") + kEarly));
  EXPECT_EQ(content_of(maps), before) << "nothing of a refused export appears";
  EXPECT_EQ(rayfield({"export", store, "-o", maps, "--date", kLate, "--format", "geotiff", "-q"}).exit_code, 0);
  EXPECT_EQ(rayfield({"export", store, "-o", work.path("new"), "--date", kLate, "-q"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(work.path("new/block.gpkg")));

  const auto sql = [&](const char* statement) {
    GDALAllRegister();
    GDALDataset* dataset = GDALDataset::Open((maps + "/block.gpkg").c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE);
    dataset->ReleaseResultSet(dataset->ExecuteSQL(statement, nullptr, nullptr));
    GDALClose(dataset);
  };
  sql("ALTER TABLE panel ADD COLUMN grower TEXT");
  const Outcome foreign = rayfield({"export", store, "-o", maps});
  EXPECT_EQ(foreign.exit_code, 2);
  EXPECT_THAT(foreign.err, HasSubstr("'grower'"));
  const Outcome update_refused = rayfield(update(store, maps, kLate));
  EXPECT_EQ(update_refused.exit_code, 2);
  EXPECT_THAT(update_refused.err, HasSubstr("'grower'"));
  EXPECT_EQ(rayfield({"export", store, "-o", maps, "--overwrite", "-q"}).exit_code, 0);
  EXPECT_EQ(rayfield({"export", store, "-o", maps, "-q"}).exit_code, 0) << "the column is gone";
}

TEST_F(Update, ABatchGoesOnAfterAFailureAndEndsWithATable) {
  const Folder work;
  write_file(work.path("blocks.toml"), "[[block]]\nstore = \"north\"\ninputs = [\"" + cloud(kLate) +
                                           "\"]\ndate = 2021-07-01\ncrs = \"EPSG:32632\"\noutput = \"maps\"\n"
                                           "[[block]]\nstore = \"absent\"\ninputs = [\"x.ply\"]\ndate = 2021-07-01\n"
                                           "[[block]]\nstore = \"south\"\ninputs = [\"missing.ply\"]\n"
                                           "date = 2021-07-01\ncrs = \"EPSG:32632\"\n"
                                           "[[block]]\nstore = \"north\"\ninputs = [\"" +
                                           cloud(kEarly) + "\"]\ndate = 2021-05-01\noutput = \"maps\"\n");
  const Outcome table = rayfield({"update", "--batch", work.path("blocks.toml")});
  EXPECT_EQ(table.exit_code, 3) << "that of the first failure";
  EXPECT_THAT(table.out, HasSubstr("north   done    2021-07-01"));
  EXPECT_THAT(table.out, HasSubstr("absent  failed  cannot open the store"));
  EXPECT_THAT(table.out, HasSubstr("north   done    2021-05-01"));
  EXPECT_TRUE(fs::exists(work.path("maps/north.gpkg")));

  const Outcome again = rayfield({"update", "--batch", work.path("blocks.toml"), "--json", "-q"});
  EXPECT_EQ(again.exit_code, 3);
  const json blocks = json::parse(again.out)["blocks"];
  ASSERT_EQ(blocks.size(), 4U);
  EXPECT_EQ(blocks[0]["already_there"], true);
  EXPECT_EQ(blocks[0]["products_written"], 0);
  EXPECT_EQ(blocks[1]["error"]["code"], 3);
  EXPECT_EQ(blocks[3]["scan_id"], kEarly);

  const Outcome interrupted = rayfield_interrupted_at(
      {"update", "--batch", work.path("blocks.toml"), "--overwrite", "--json", "--progress", "plain"}, "2021-07-01");
  EXPECT_EQ(interrupted.exit_code, 130) << interrupted.err;
  EXPECT_EQ(json::parse(interrupted.out)["blocks"][3]["not_begun"], true);
}

TEST_F(Update, SaysWhatItLacks) {
  const Folder work;
  const std::string store = work.path("block");
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"update"},
                                                    {"update", store},
                                                    {"update", store, cloud(kLate)},
                                                    {"update", store, cloud(kLate), "--date", "2021-02-30"},
                                                    {"update", store, "--batch", "x.toml"}}) {
    const Outcome run = rayfield(arguments);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_EQ(run.error_lines(), 1) << run.err;
  }
  EXPECT_EQ(rayfield({"update", store, cloud(kLate), "--date", kLate}).exit_code, 3) << "no store, and no CRS for one";
  EXPECT_FALSE(fs::exists(store));
  run(update(store, work.path("maps"), kLate));
  const Outcome other = rayfield({"update", store, cloud(kLate), "--date", kLate, "--crs", "EPSG:32633"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("EPSG:32632"));
}

}  // namespace
}  // namespace rayfield::test
