#include "rayfield/formats/trajectory_file.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "formats/io/file_io.h"

namespace rayfield::formats {
namespace {

constexpr const char* kRead = "cannot read trajectory";
constexpr const char* kWrite = "cannot write trajectory";
constexpr double kUnitTolerance = 1e-3;
constexpr std::size_t kLongestLine = 4096;

/// The eight numbers of a line; nothing where there are fewer, more or other things.
std::optional<std::array<double, 8>> parse_pose(std::string_view line) {
  std::array<double, 8> values{};
  for (double& value : values) {
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return std::nullopt;
    line.remove_prefix(begin);
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    if (!line.empty() && line.front() != ' ' && line.front() != '\t') return std::nullopt;
  }
  if (line.find_first_not_of(" \t") != std::string_view::npos) return std::nullopt;
  return values;
}

void take_comment(std::string_view line, Trajectory& trajectory) {
  line.remove_prefix(1);
  const auto value_of = [line](std::string_view key) -> std::optional<std::string> {
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos || !line.substr(begin).starts_with(key)) return std::nullopt;
    const std::string_view rest = line.substr(begin + key.size());
    const std::size_t first = rest.find_first_not_of(" \t");
    return std::string(first == std::string_view::npos ? std::string_view() : rest.substr(first));
  };
  if (const auto crs = value_of("crs:")) trajectory.crs = *crs;
  if (const auto frame = value_of("frame:")) trajectory.frame = *frame;
}

Result<void> take_line(std::string_view line, const std::string& where, Trajectory& trajectory) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (line.find_first_not_of(" \t") == std::string_view::npos) return {};
  if (line.front() == '#') {
    take_comment(line, trajectory);
    return {};
  }
  const std::optional<std::array<double, 8>> v = parse_pose(line);
  if (!v) {
    return fail(ErrorCode::bad_input, kRead, where, "not the eight numbers t x y z qx qy qz qw",
                "give a trajectory in TUM format");
  }
  const Eigen::Quaterniond rotation((*v)[7], (*v)[4], (*v)[5], (*v)[6]);
  if (!(std::abs(rotation.norm() - 1.0) <= kUnitTolerance)) {
    return fail(ErrorCode::bad_input, kRead, where, "the quaternion is not unit");
  }
  if (!trajectory.poses.empty() && (*v)[0] <= trajectory.poses.back().time_s) {
    return fail(ErrorCode::bad_input, kRead, where, "the time is not later than in the line before");
  }
  trajectory.poses.push_back({(*v)[0], {rotation.normalized(), {(*v)[1], (*v)[2], (*v)[3]}}});
  return {};
}

bool one_line(const std::string& text) { return text.find_first_of("\r\n") == std::string::npos; }

}  // namespace

Result<Trajectory> read_trajectory(const std::string& path) {
  RAYFIELD_ASSIGN(InputFile file, InputFile::open(path, kRead));
  FileWindow window(std::move(file));
  Trajectory trajectory;
  std::uint64_t at = 0, number = 0;
  while (at < window.file().size()) {
    ++number;
    const std::string where = path + ", line " + std::to_string(number);
    RAYFIELD_ASSIGN(const std::span<const std::byte> bytes, window.view(at, kLongestLine));
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t newline = text.find('\n');
    if (newline == std::string_view::npos && text.size() == kLongestLine) {
      return fail(ErrorCode::bad_input, kRead, where, "the line is longer than 4096 bytes: no trajectory");
    }
    const std::string_view line = text.substr(0, newline);
    RAYFIELD_CHECK(take_line(line, where, trajectory));
    at += line.size() + 1;
  }
  if (trajectory.poses.empty()) return fail(ErrorCode::bad_input, kRead, path, "it holds no poses");
  return trajectory;
}

Result<void> write_trajectory(const std::string& path, const Trajectory& trajectory) {
  if (!one_line(trajectory.crs) || !one_line(trajectory.frame)) {
    return fail(ErrorCode::usage, kWrite, path, "the name of the CRS or of the frame has a line break");
  }
  RAYFIELD_ASSIGN(OutputFile file, OutputFile::create(path, kWrite));
  std::string text;
  if (!trajectory.crs.empty()) text += "# crs: " + trajectory.crs + "\n";
  if (!trajectory.frame.empty()) text += "# frame: " + trajectory.frame + "\n";
  text += "# position: easting northing height, m; orientation: frame relative to grid east, north, up\n";
  text += "# t x y z qx qy qz qw\n";
  RAYFIELD_CHECK(file.write(text));
  double last_s = -std::numeric_limits<double>::infinity();
  for (const TimedPose& pose : trajectory.poses) {
    const Eigen::Vector3d& p = pose.map_from_body.translation;
    const Eigen::Quaterniond& q = pose.map_from_body.rotation;
    if (!p.allFinite() || !q.coeffs().allFinite() || !std::isfinite(pose.time_s) || pose.time_s <= last_s) {
      return fail(ErrorCode::usage, kWrite, path, "a pose is not finite, or its time is not later than the one before");
    }
    last_s = pose.time_s;
    RAYFIELD_CHECK(file.write(fmt::format("{:.7f} {:.6f} {:.6f} {:.6f} {:.10f} {:.10f} {:.10f} {:.10f}\n", pose.time_s,
                                          p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w())));
  }
  return file.commit();
}

}  // namespace rayfield::formats
