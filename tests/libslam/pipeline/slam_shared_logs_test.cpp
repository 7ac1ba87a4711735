#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "rayfield/core/map_frame.h"
#include "rayfield/formats/rig_file.h"
#include "rayfield/formats/sensor_log.h"
#include "rayfield/formats/trajectory_file.h"
#include "rayfield/slam/slam.h"
#include "tests/libslam/trajectory_errors.h"

// The shared bags, from bag to trajectory, against truth. Bounds are the project's goals, not what was once measured.
namespace rayfield::slam {
namespace {

struct SharedLog {
  const char* folder;
  const char* rig;
  double ate_rms_m;  // goal
};

class SharedLogs : public ::testing::TestWithParam<SharedLog> {
 protected:
  void SetUp() override {
    const char* shared = std::getenv("RAYFIELD_SHARED");
    folder_ = std::filesystem::path(shared != nullptr ? shared : RAYFIELD_SHARED_DEFAULT) / "data" / GetParam().folder;
    if (!std::filesystem::exists(folder_ / "scan.bag")) GTEST_SKIP() << "no shared data in " << folder_;
  }

  // True poses in the map: site.json holds the origin of the local frame.
  std::vector<TimedPose> truth() const {
    std::ifstream file(folder_ / "truth/site.json");
    const auto site = nlohmann::json::parse(file);
    const TangentPlane plane({site["lat"].get<double>(), site["lon"].get<double>(), site["alt"].get<double>()});
    const auto frame = MapFrame::create("EPSG:7854");
    auto local = formats::read_trajectory((folder_ / "truth/trajectory.tum").string());
    EXPECT_TRUE(frame && local);
    const Eigen::Matrix3d j = map_from_enu_jacobian(*frame, plane, Eigen::Vector3d::Zero());
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(std::atan2(j(1, 0), j(0, 0)), Eigen::Vector3d::UnitZ()));
    for (TimedPose& p : local->poses) {
      p.map_from_body.translation = frame->map_from_geodetic(plane.geodetic_from_enu(p.map_from_body.translation));
      p.map_from_body.rotation = turn * p.map_from_body.rotation;
    }
    return local->poses;
  }

  std::filesystem::path folder_;
};

// Root mean square of the distance between fixes and the antenna's true path.
double gps_error(const std::vector<GpsMark>& marks, const std::vector<TimedPose>& truth, const Rig& rig) {
  double sum = 0;
  for (const GpsMark& m : marks)
    sum += (m.position - testing::pose_at(truth, m.time_s) * rig.imu_from_gps_m).norm() /
           static_cast<double>(marks.size());
  return sum;
}

TEST_P(SharedLogs, AreReconstructedWithinTheGoals) {
  const auto rig = formats::read_rig((folder_ / GetParam().rig).string());
  ASSERT_TRUE(rig) << rig.error().line();
  const LogReader read = [&](SensorSink& sink) -> Result<void> {
    const auto report = formats::read_log((folder_ / "scan.bag").string(), *rig, sink);
    if (!report) return tl::make_unexpected(report.error());
    return {};
  };
  Progress progress;
  const auto result = run_slam(read, *rig, "EPSG:7854", SlamOptions(), progress);
  ASSERT_TRUE(result) << result.error().line();
  const auto true_poses = truth();
  const testing::TrajectoryErrors e = testing::trajectory_errors(result->trajectory.poses, true_poses);
  RecordProperty("ate_rms_mm", static_cast<int>(1000 * e.ate_rms_m));
  RecordProperty("ate_max_mm", static_cast<int>(1000 * e.ate_max_m));
  EXPECT_LE(e.ate_rms_m, GetParam().ate_rms_m);
  EXPECT_LE(e.ate_max_m, 0.15);
  EXPECT_LE(e.drift_percent, 0.5);
  EXPECT_LE(e.georeferenced_rms_m, gps_error(result->gps, true_poses, *rig) + 0.10);
  EXPECT_LE(result->report.surfel_thickness_m, 0.025);
  if (rig->lidar.beam) {
    EXPECT_NEAR(result->report.range_resolution_m, 0.15, 0.05);
  }
  EXPECT_TRUE(result->report.georeferenced);
  EXPECT_GT(result->report.linked_visits, 20u);                                       // every lane sees its neighbours
  EXPECT_GT(result->trajectory.poses.back().time_s, true_poses.back().time_s - 0.2);  // nothing is left off the end
}

// block_a: beams without width. block_b: beams of 37 mm at 2 m, whose spot on the ground is longer than the lidar
// resolves.
INSTANTIATE_TEST_SUITE_P(Dates, SharedLogs,
                         ::testing::Values(SharedLog{"block_a/2019-02-11", "rig.toml", 0.05},
                                           SharedLog{"block_a/2018-12-12", "rig.toml", 0.05},
                                           SharedLog{"block_b/2019-08-05", "rig_beam.toml", 0.015},
                                           SharedLog{"block_b/2019-11-15", "rig_beam.toml", 0.015},
                                           SharedLog{"block_b/2020-01-20", "rig_beam.toml", 0.015}),
                         [](const auto& log) {
                           std::string name = log.param.folder;
                           for (char& c : name)
                             if (c == '/' || c == '-') c = '_';
                           return name;
                         });

}  // namespace
}  // namespace rayfield::slam
