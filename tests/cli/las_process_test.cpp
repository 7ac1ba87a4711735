#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "rayfield/core/ray_source.h"
#include "rayfield/formats/ply_reader.h"
#include "rayfield/formats/ply_writer.h"
#include "tests/cli/program.h"
#include "tests/formats/las_support.h"

namespace rayfield::test {
namespace {

using formats::bytes::LasSpec;
using formats::bytes::LasTestPoint;
using testing::HasSubstr;

constexpr double kAdjustedGps_s = 18 - 1315964800.0;  // added to Unix time of today

/// A simulated drive as the cloud of its hits: in PLY, and in LAS beside the true path of the IMU.
class LasProcess : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    work_ = new Folder;
    ASSERT_EQ(rayfield({"simulate", small_site(*work_, kLateDate), "-o", work_->path("logs"), "-q"}).exit_code, 0);
    const auto reader = formats::PlyReader::open(drive("rays.ply")).value();
    formats::PlyWriter ply = formats::PlyWriter::create(work_->path("hits.ply"), {*reader->crs()}).value();
    LasSpec spec;
    spec.scale = 1e-4;
    RayBatch rays, hits;
    while (reader->read(rays, 65536).value() > 0) {
      hits.clear();
      if (spec.offset.isZero()) spec.offset = rays.origin[0].array().round();
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (rays.hit[i] == 0) continue;
        hits.push(rays.origin[i], rays.end[i], rays.time_s[i], rays.intensity[i], true);
        LasTestPoint point;
        point.position = rays.end[i], point.time_s = rays.time_s[i] + kAdjustedGps_s;
        point.intensity = rays.intensity[i];
        spec.points.push_back(point);
      }
      ASSERT_TRUE(ply.write(hits));
    }
    ASSERT_TRUE(ply.close());
    points_ = spec.points.size();
    write_file(work_->path("hits.las"), formats::bytes::las_bytes(spec));
  }
  static void TearDownTestSuite() { delete work_; }
  static std::string drive(const std::string& name) { return work_->path("logs/2021-07-01/" + name); }
  static nlohmann::json plants_of(const std::string& store, const std::vector<std::string>& inputs) {
    std::vector<std::string> words = {"update", store, "--crs", "EPSG:32632", "--date", "2021-07-01", "-q"};
    words.insert(words.end(), inputs.begin(), inputs.end());
    const Outcome run = rayfield(words);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(rayfield({"process", store, "--json", "-q"}).out)["scans"][0];
  }
  static Folder* work_;
  static std::size_t points_;
};
Folder* LasProcess::work_ = nullptr;
std::size_t LasProcess::points_ = 0;

// Without the spinner's angle rays begin up to its 35 mm beside the lidar.
TEST_F(LasProcess, GivesThePlantAreaOfTheSameCloudWithRayStarts) {
  const Folder work;
  const std::vector<std::string> las = {work_->path("hits.las"), "--trajectory", drive("truth/trajectory_map.tum"),
                                        "--rig", drive("rig.toml")};
  const auto from_las = plants_of(work.path("las"), las);
  const auto from_ply = plants_of(work.path("ply"), {work_->path("hits.ply"), "--rig", drive("rig.toml")});
  const double las_m2 = from_las["plant_area_m2"].get<double>(), ply_m2 = from_ply["plant_area_m2"].get<double>();
  EXPECT_NEAR(las_m2 / ply_m2, 1, 0.02);
  EXPECT_EQ(from_las["panels_with_value"], from_ply["panels_with_value"]);
}

TEST_F(LasProcess, GivesTheSameBytesAtAnyMemoryAndNumberOfThreads) {
  const Folder work;
  std::map<std::string, std::string> first;
  for (const auto& [threads, memory] : std::vector<std::pair<std::string, std::string>>{{"1", "256M"}, {"4", "2G"}}) {
    const std::string store = work.path("t" + threads);
    ASSERT_EQ(rayfield({"init", store, "--crs", "EPSG:32632"}).exit_code, 0);
    const Outcome run =
        rayfield({"add", store, work_->path("hits.las"), "--trajectory", drive("truth/trajectory_map.tum"), "--date",
                  "2021-07-01", "--threads", threads, "--memory", memory, "-q"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    if (first.empty()) first = content_of(store);
    EXPECT_EQ(content_of(store), first);
  }
}

// Ten times the points, one after the other in time: 140 MB of LAS.
TEST_F(LasProcess, StaysWithinTheMemoryAndStopsWhenAsked) {
  const Folder work;
  const std::string content = read_file(work_->path("hits.las")), large = work.path("large.las");
  constexpr std::size_t kHeader = 375, kTimes = 10;
  {
    std::ofstream out(large, std::ios::binary);
    out << formats::bytes::patched(content.substr(0, kHeader), 247, formats::bytes::u64(kTimes * points_));
    for (std::size_t i = 0; i < kTimes; ++i) out << content.substr(kHeader);
  }
  const std::string store = work.path("block");
  ASSERT_EQ(rayfield({"init", store, "--crs", "EPSG:32632"}).exit_code, 0);
  const std::vector<std::string> words = {
      "add",    store,        large,      "--trajectory", drive("truth/trajectory_map.tum"),
      "--date", "2021-07-01", "--memory", "256M"};
  const auto before = content_of(store);
  const Outcome stopped = rayfield_interrupted_at(words, "tiling");
  EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("run the same command again"));
  const Outcome run = rayfield(words);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_LE(run.peak_bytes, std::uint64_t{256} << 20);
  EXPECT_NE(content_of(store), before);
}

}  // namespace
}  // namespace rayfield::test
