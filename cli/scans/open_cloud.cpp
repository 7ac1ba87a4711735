#include "cli/scans/open_cloud.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

#include "cli/drives/drive_log.h"
#include "rayfield/core/file.h"
#include "rayfield/core/map_frame.h"
#include "rayfield/formats/las_reader.h"
#include "rayfield/formats/ply_reader.h"

namespace rayfield::cli {
namespace {

namespace fs = std::filesystem;

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// `shown`: the CRS for people, of WKT its name.
Result<void> check_cloud_crs(const std::optional<std::string>& own, const std::string& shown, const std::string& crs,
                             const fs::path& path) {
  constexpr const char* kWhat = "cannot add ray cloud";
  if (own && *own == kLocalFrame)
    return fail(ErrorCode::bad_input, kWhat, path.string(), fmt::format("it is in a local frame, the store in {}", crs),
                "register its log with GPS and --crs " + crs);
  if (own && !same_crs(*own, crs))
    return fail(ErrorCode::bad_input, kWhat, path.string(), fmt::format("it is in {}, the store in {}", shown, crs),
                "transform it, or make a store in its CRS");
  return {};
}

// Where the sensor stands in the frame of the trajectory's body; what keeps the rig's word from being taken is said.
Eigen::Vector3d lever_arm_m(const formats::TrajectoryFile& poses, const formats::RigMounting& mounting,
                            std::vector<std::string>& warnings) {
  Eigen::Vector3d arm_m = mounting.lidar_in_imu_m.value_or(Eigen::Vector3d::Zero());
  if (arm_m.isZero(0) || lower_case(poses.frame) == "lidar") return Eigen::Vector3d::Zero();
  if (poses.has_orientation) return arm_m;
  warnings.push_back(
      fmt::format("the trajectory has no orientations: rays begin on it, not at the lidar, {:.2f} m away by the rig",
                  arm_m.norm()));
  return Eigen::Vector3d::Zero();
}

Result<OpenedCloud> open_las(const fs::path& path, const ScanInputs& inputs, const std::string& crs,
                             const CloudTrajectory& trajectory, Progress& progress) {
  formats::LasReadOptions options;
  std::vector<std::string> ignored;  // said when the trajectory was read
  options.lever_arm_m = lever_arm_m(*trajectory.poses, trajectory.mounting, ignored);
  options.time_offset_s = trajectory.mounting.lidar_offset_s;
  options.allow_truncated = inputs.allow_truncated;
  options.cancelled = [&progress] { return progress.cancelled(); };
  RAYFIELD_ASSIGN(auto reader, formats::LasReader::open(path.string(), trajectory.poses, options));
  RAYFIELD_CHECK(check_cloud_crs(reader->crs(), reader->crs_name(), crs, path));
  OpenedCloud cloud;
  for (const std::string& note : reader->notes()) cloud.notes.push_back(path.filename().string() + ": " + note);
  cloud.rays = std::move(reader);
  return cloud;
}

}  // namespace

bool is_las(const fs::path& path) {
  const std::string name = lower_case(path.filename().string());
  if (name.ends_with(".las") || name.ends_with(".laz")) return true;
  constexpr std::string_view kMagic = "LASF";
  std::array<std::byte, kMagic.size()> head{};
  const auto file = open_regular_file(path.string(), "cannot read");
  if (!file || !read_at(file->descriptor, 0, head, "cannot read", path.string())) return false;
  return std::memcmp(head.data(), kMagic.data(), kMagic.size()) == 0;
}

Result<void> check_trajectory_given(const ScanInputs& inputs) {
  const auto las = std::find_if(inputs.files.begin(), inputs.files.end(), is_las);
  if (las != inputs.files.end() && inputs.trajectory_file.empty())
    return fail(ErrorCode::usage, "cannot add LAS cloud", las->string(),
                "it says where points lie, not where the sensor stood", "give --trajectory with the path of its drive");
  if (las == inputs.files.end() && !inputs.trajectory_file.empty() && !inputs.files.empty())
    return fail(ErrorCode::usage, "cannot use trajectory", inputs.trajectory_file,
                "only LAS clouds take one, and " + inputs.files.front().string() + " is none",
                "leave --trajectory out; logs take one in `rayfield slam --use-trajectory`");
  return {};
}

std::uint64_t CloudTrajectory::bytes() const { return poses ? poses->poses.capacity() * sizeof(TimedPose) : 0; }

Result<CloudTrajectory> read_cloud_trajectory(const ScanInputs& inputs, const std::string& crs,
                                              std::uint64_t memory_bytes, Progress& progress) {
  constexpr std::uint64_t kShare = 4;
  CloudTrajectory trajectory;
  if (inputs.trajectory_file.empty()) return trajectory;
  progress.stage("reading trajectory", 0, "poses");
  // A vector that grows holds its poses twice, and half as much again.
  formats::TrajectoryReadOptions options;
  options.max_poses = static_cast<std::size_t>(memory_bytes / kShare / sizeof(TimedPose) / 2);
  options.cancelled = [&progress] { return progress.cancelled(); };
  RAYFIELD_ASSIGN(formats::TrajectoryFile given, formats::read_trajectory(inputs.trajectory_file, options));
  if (!given.crs.empty() && !same_crs(given.crs, crs))
    return fail(ErrorCode::usage, "cannot use trajectory", inputs.trajectory_file,
                fmt::format("it is in {}, not in {}", given.crs, crs), "transform it");
  if (!inputs.rig_file.empty()) {
    RAYFIELD_ASSIGN(trajectory.mounting, formats::read_rig_mounting(inputs.rig_file));
  }
  lever_arm_m(given, trajectory.mounting, trajectory.warnings);
  trajectory.warnings.emplace_back(
      "LAS has no rays that hit nothing: canopy above the sensor's height reads too dense (docs/ray-cloud-las.md)");
  trajectory.poses = std::make_shared<const formats::TrajectoryFile>(std::move(given));
  return trajectory;
}

Result<OpenedCloud> open_cloud(const fs::path& path, const ScanInputs& inputs, const std::string& crs,
                               const CloudTrajectory& trajectory, Progress& progress) {
  if (is_las(path)) return open_las(path, inputs, crs, trajectory, progress);
  RAYFIELD_ASSIGN(auto reader,
                  formats::PlyReader::open(path.string(), {.allow_truncated = inputs.allow_truncated,
                                                           .cancelled = [&progress] { return progress.cancelled(); }}));
  RAYFIELD_CHECK(check_cloud_crs(reader->crs(), reader->crs().value_or(""), crs, path));
  OpenedCloud cloud;
  cloud.beam = reader->beam();
  cloud.rays = std::move(reader);
  return cloud;
}

}  // namespace rayfield::cli
