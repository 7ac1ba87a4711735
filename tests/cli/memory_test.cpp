#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "rayfield/core/ray.h"
#include "rayfield/formats/ply_writer.h"
#include "tests/cli/program.h"

/// --memory is a bound on what a command has resident, whatever the size of the block.
namespace rayfield::test {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

/// Rows running north-east, each seen from both sides by a few rays per metre: ground, canopy and a post every 5 m.
struct RowGroup {
  Eigen::Vector2d start = {500100, 6100100};
  int rows = 3;
  double length_m = 60, spacing_m = 3;
};

class SparseDrive {
 public:
  explicit SparseDrive(const std::string& path)
      : writer_(formats::PlyWriter::create(path, {"EPSG:7854"}).value()), random_(7) {}

  void drive(const RowGroup& group) {
    for (int lane = 0; lane <= group.rows; ++lane) drive_lane(group, lane);
  }
  void close() { ASSERT_TRUE(writer_.close()); }

 private:
  static constexpr double kRaysPerMetre = 150, kSpeed = 1.25, kSensorUp = 1.8, kGroundUp = 100;

  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double around(double sigma) { return std::normal_distribution<double>(0, sigma)(random_); }

  void drive_lane(const RowGroup& group, int lane) {
    const Eigen::Vector2d along = Eigen::Vector2d(1, 1).normalized(), left(-along.y(), along.x());
    const double lane_across = (lane - 0.5) * group.spacing_m, way = group.length_m + 4;
    RayBatch rays;
    for (int i = 0; i < static_cast<int>(way * kRaysPerMetre); ++i) {
      const double done = i / kRaysPerMetre, at = lane % 2 == 0 ? done - 2 : group.length_m + 2 - done;
      const int row = lane - (between(0, 1) < 0.5 ? 1 : 0);  // to its right or to its left
      const double row_across = row * group.spacing_m, kind = between(0, 1);
      Eigen::Vector3d end(at + around(0.8), row_across, 0);  // along, across, up
      if (kind < 0.45 || row < 0 || row >= group.rows) {
        end.y() = lane_across + between(-0.45, 0.45) * group.spacing_m, end.z() = around(0.005);
      } else if (kind < 0.9) {
        end.y() += around(0.12), end.z() = between(0.8, 1.7);
      } else {
        const double turn = between(0, 2 * M_PI);
        end.x() = 5 * std::round(end.x() / 5) + 0.05 * std::cos(turn);
        end.y() += 0.05 * std::sin(turn), end.z() = between(0, 1.8);
      }
      if (end.z() > 0.1 && (end.x() < -0.2 || end.x() > group.length_m + 0.2)) continue;
      const auto in_map = [&](const Eigen::Vector3d& p) {
        const Eigen::Vector2d plan = group.start + p.x() * along + p.y() * left;
        return Eigen::Vector3d(plan.x(), plan.y(), kGroundUp + p.z());
      };
      rays.push(in_map({at, lane_across, kSensorUp}), in_map(end), clock_s_ + done / kSpeed, 128, true);
    }
    clock_s_ += way / kSpeed + 20;
    ASSERT_TRUE(writer_.write(rays));
  }

  formats::PlyWriter writer_;
  std::mt19937_64 random_;
  double clock_s_ = 1.55e9;
};

class Memory : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers keep memory of their own";
#endif
  }
  std::string add(const std::string& name, const std::vector<RowGroup>& groups) {
    SparseDrive drive(folder_.path(name + ".ply"));
    for (const RowGroup& group : groups) drive.drive(group);
    drive.close();
    EXPECT_EQ(rayfield({"init", folder_.path(name), "--crs", "EPSG:7854", "-q"}).exit_code, 0);
    const Outcome run = rayfield({"add", folder_.path(name), folder_.path(name + ".ply"), "--date", "2019-02-11",
                                  "--no-align", "--memory", "256M", "-q"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_LT(run.peak_bytes, 256 * kMiB);
    return folder_.path(name);
  }
  std::string copy_of(const std::string& store, const std::string& name) {
    std::filesystem::copy(store, folder_.path(name), std::filesystem::copy_options::recursive);
    return folder_.path(name);
  }
  Folder folder_;
};

// The maps of this block have 24 million cells, of which a few in a hundred lie in rows. `process` took 1.5 GiB when
// maps were held as a whole.
TEST_F(Memory, ABlockMuchLargerThanTheBoundIsProcessedAndExportedWithinIt) {
  const std::string store = add("wide", {{{500100, 6100100}}, {{500500, 6100500}}}), other = copy_of(store, "other");
  const Outcome run = rayfield({"process", store, "--memory", "256M", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_LT(run.peak_bytes, 256 * kMiB);
  const Outcome maps = rayfield(
      {"export", store, "-o", folder_.path("maps"), "--format", "geotiff,gpkg,geojson,csv", "--memory", "256M", "-q"});
  ASSERT_EQ(maps.exit_code, 0) << maps.err;
  EXPECT_LT(maps.peak_bytes, 256 * kMiB);
  for (const char* command : {"status", "verify"}) {
    const Outcome look = rayfield({command, store, "--memory", "256M", "-q"});
    EXPECT_EQ(look.exit_code, 0) << look.err;
    EXPECT_LT(look.peak_bytes, 256 * kMiB) << command;
  }
  // And the same bytes as with all the memory that it could want, and another number of threads.
  ASSERT_EQ(rayfield({"process", other, "--memory", "8G", "--threads", "3", "-q"}).exit_code, 0);
  EXPECT_EQ(content_of(store), content_of(other));
}

// Each of four rows fits into the smallest bound, all at once do not.
TEST_F(Memory, RowsThatWouldNotFitTogetherAreProcessedWithinTheSmallestBound) {
  const std::string store = add("rows", {{{500100, 6100100}, 4, 180}}), other = copy_of(store, "other");
  const Outcome run = rayfield({"process", store, "--memory", "256M", "--threads", "4", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_LT(run.peak_bytes, 256 * kMiB);
  const Outcome roomy = rayfield({"process", other, "--memory", "8G", "--threads", "4", "-q"});
  ASSERT_EQ(roomy.exit_code, 0) << roomy.err;
  EXPECT_GT(roomy.peak_bytes, 300 * kMiB) << "it would fit by itself";
  EXPECT_EQ(content_of(store), content_of(other));
}

TEST_F(Memory, ARowTooLongForTheBoundIsRefusedInOneLineThatSaysWhatItTakes) {
  const std::string store = add("long", {{{500100, 6100100}, 1, 700}});
  const Outcome refused = rayfield({"process", store, "--memory", "256M"});
  EXPECT_EQ(refused.exit_code, 5) << refused.err;
  EXPECT_EQ(refused.error_lines(), 1) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("row 1: its voxels take"));
  const std::size_t advice = refused.err.find("give --memory ");
  ASSERT_NE(advice, std::string::npos) << refused.err;
  const std::string amount = refused.err.substr(advice + 14, refused.err.find(' ', advice + 14) - advice - 14);
  const Outcome run = rayfield({"process", store, "--memory", amount, "-q"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_LT(run.peak_bytes, std::stoull(amount) * kMiB) << amount;
}

}  // namespace
}  // namespace rayfield::test
