#include "rayfield/formats/trajectory_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "formats/io/file_io.h"
#include "formats/vehicle/bzip2_text.h"
#include "formats/vehicle/trajectory_columns.h"

namespace rayfield::formats {
namespace {

constexpr const char* kRead = "cannot read trajectory";
constexpr const char* kWrite = "cannot write trajectory";
constexpr double kUnitTolerance = 1e-3;
constexpr std::size_t kLongestLine = 4096;
// Places and times that a store could hold (docs/store-format.md, "Geometry").
constexpr double kFarthest_m = 1e8, kHighest_m = 1e5, kLatest_s = 1e11;

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

void take_comment(std::string_view line, TrajectoryFile& trajectory) {
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

/// What is read line by line.
struct TrajectoryParser {
  const TrajectoryReadOptions& options;
  TrajectoryFile trajectory;
  std::optional<TrajectoryColumns> columns;  // of a table
  bool has_begun = false;                    // a line that is no comment went by

  Result<void> line(std::string_view text, const std::string& where);

 private:
  Result<bool> take_header(std::string_view text, const std::string& where);
  Result<void> take_pose(const std::array<double, 8>& v, const std::string& where);
};

// Whether the first line names columns. One that begins like a comment is a header only if the time comes first and all
// that is needed follows: "# time of the drive: …" is none, nor is "# crs: t x y z". Names in the order of TUM leave
// lines as strict as they are without.
Result<bool> TrajectoryParser::take_header(std::string_view text, const std::string& where) {
  const bool is_comment = text.front() == '#' || text.front() == '%';
  const auto found = find_trajectory_columns(text);
  if (!found && !is_comment) return fail(found.error().code, kRead, where, found.error().why, found.error().next);
  if (!found || !*found || (is_comment && (*found)->time != 0)) return false;
  trajectory.has_orientation = (*found)->quaternion.has_value();
  if (!(*found)->are_tum()) columns = *found;
  return true;
}

Result<void> TrajectoryParser::line(std::string_view text, const std::string& where) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (!has_begun && text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (text.ends_with('\r')) text.remove_suffix(1);
  if (text.find_first_not_of(" \t") == std::string_view::npos) return {};
  if (text.front() == '#' || text.front() == '%') {
    take_comment(text, trajectory);
    if (!has_begun && !columns) RAYFIELD_CHECK(take_header(text, where));
    return {};
  }
  const std::optional<std::array<double, 8>> pose = columns ? parse_columns(text, *columns) : parse_pose(text);
  const bool is_first = !std::exchange(has_begun, true);
  if (pose) return take_pose(*pose, where);
  if (is_first && !columns) {
    RAYFIELD_ASSIGN(const bool is_header, take_header(text, where));
    if (is_header) return {};
  }
  if (columns)
    return fail(ErrorCode::bad_input, kRead, where, "not a number in each column that the header names",
                "check the header line, or write the trajectory again");
  return fail(ErrorCode::bad_input, kRead, where, "not the eight numbers t x y z qx qy qz qw",
              "give a trajectory in TUM format, or a table whose first line names its columns: time, x, y, z");
}

Result<void> TrajectoryParser::take_pose(const std::array<double, 8>& v, const std::string& where) {
  constexpr std::size_t kAskedEvery = 65536;
  if (!(std::abs(v[1]) <= kFarthest_m && std::abs(v[2]) <= kFarthest_m && std::abs(v[3]) <= kHighest_m &&
        std::abs(v[0]) <= kLatest_s))
    return fail(ErrorCode::bad_input, kRead, where, "its time or place is none on Earth",
                "give times in seconds since 1970 and places in metres");
  const Eigen::Quaterniond rotation(v[7], v[4], v[5], v[6]);
  if (!(std::abs(rotation.norm() - 1.0) <= kUnitTolerance)) {
    return fail(ErrorCode::bad_input, kRead, where, "the quaternion is not unit");
  }
  std::vector<TimedPose>& poses = trajectory.poses;
  if (!poses.empty() && v[0] <= poses.back().time_s) {
    return fail(ErrorCode::bad_input, kRead, where, "the time is not later than in the line before");
  }
  if (poses.size() >= options.max_poses)
    return fail(ErrorCode::resources, kRead, where,
                fmt::format("more than {} poses do not fit in memory", options.max_poses),
                "give more with --memory, or fewer poses");
  if (options.cancelled && poses.size() % kAskedEvery == 0 && options.cancelled())
    return fail(ErrorCode::interrupted, "interrupted", where, "", "run the same command again");
  poses.push_back({v[0], {rotation.normalized(), {v[1], v[2], v[3]}}});
  return {};
}

bool one_line(const std::string& text) { return text.find_first_of("\r\n") == std::string::npos; }

// Line by line through a window, so that a long trajectory takes no more memory than its poses.
Result<void> read_lines(FileWindow& window, TrajectoryParser& parser) {
  std::uint64_t at = 0, number = 0;
  const std::string& path = window.file().path();
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
    RAYFIELD_CHECK(parser.line(line, where));
    at += line.size() + 1;
  }
  return {};
}

Result<void> read_packed(FileWindow& window, TrajectoryParser& parser) {
  const std::string& path = window.file().path();
  RAYFIELD_ASSIGN(const std::span<const std::byte> bytes, window.view(0, window.file().size()));
  auto text = unpack_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!text) return fail(text.error().code, kRead, path, text.error().why, text.error().next);
  std::uint64_t number = 0;
  for (std::string_view rest = *text; !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    RAYFIELD_CHECK(parser.line(line, path + ", line " + std::to_string(++number)));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  }
  return {};
}

std::string header_of(const TrajectoryFile& trajectory) {
  std::string text;
  if (!trajectory.crs.empty()) text += "# crs: " + trajectory.crs + "\n";
  if (!trajectory.frame.empty()) text += "# frame: " + trajectory.frame + "\n";
  text += "# position: easting northing height, m; orientation: frame relative to grid east, north, up\n";
  text += "# t x y z qx qy qz qw\n";
  return text;
}

/// Decimals of the numbers in a line.
struct Digits {
  int time = 7, position = 6, quaternion = 10;
};

std::string line_of(const TimedPose& pose, const Digits& digits) {
  const Eigen::Vector3d& p = pose.map_from_body.translation;
  const Eigen::Quaterniond& q = pose.map_from_body.rotation;
  return fmt::format("{:.{}f} {:.{}f} {:.{}f} {:.{}f} {:.{}f} {:.{}f} {:.{}f} {:.{}f}\n", pose.time_s, digits.time,
                     p.x(), digits.position, p.y(), digits.position, p.z(), digits.position, q.x(), digits.quaternion,
                     q.y(), digits.quaternion, q.z(), digits.quaternion, q.w(), digits.quaternion);
}

Result<void> check_trajectory(const TrajectoryFile& trajectory, const std::string& where) {
  if (!one_line(trajectory.crs) || !one_line(trajectory.frame))
    return fail(ErrorCode::usage, kWrite, where, "the name of the CRS or of the frame has a line break");
  double last_s = -std::numeric_limits<double>::infinity();
  for (const TimedPose& pose : trajectory.poses) {
    if (!pose.map_from_body.translation.allFinite() || !pose.map_from_body.rotation.coeffs().allFinite() ||
        !std::isfinite(pose.time_s) || pose.time_s <= last_s)
      return fail(ErrorCode::usage, kWrite, where,
                  "a pose is not finite, or its time is not later than the one before");
    last_s = pose.time_s;
  }
  return {};
}

}  // namespace

Result<TrajectoryFile> read_trajectory(const std::string& path, const TrajectoryReadOptions& options) {
  RAYFIELD_ASSIGN(InputFile file, InputFile::open(path, kRead));
  FileWindow window(std::move(file));
  RAYFIELD_ASSIGN(const std::span<const std::byte> head, window.view(0, 4));
  TrajectoryParser parser{options};
  const bool packed = is_packed({reinterpret_cast<const char*>(head.data()), head.size()});
  RAYFIELD_CHECK(packed ? read_packed(window, parser) : read_lines(window, parser));
  if (parser.trajectory.poses.empty()) return fail(ErrorCode::bad_input, kRead, path, "it holds no poses");
  return std::move(parser.trajectory);
}

Result<void> write_trajectory(const std::string& path, const TrajectoryFile& trajectory) {
  RAYFIELD_CHECK(check_trajectory(trajectory, path));
  RAYFIELD_ASSIGN(OutputFile file, OutputFile::create(path, kWrite));
  RAYFIELD_CHECK(file.write(header_of(trajectory)));
  for (const TimedPose& pose : trajectory.poses) RAYFIELD_CHECK(file.write(line_of(pose, {})));
  return file.commit();
}

// At 40 m an angle of 2·1e-8 is a micrometre: what rays of 0.1 mm need, with two digits to spare.
Result<std::string> pack_trajectory(const TrajectoryFile& trajectory) {
  RAYFIELD_CHECK(check_trajectory(trajectory, "trajectory"));
  constexpr Digits kDigits{6, 5, 8};
  std::string text = header_of(trajectory);
  for (const TimedPose& pose : trajectory.poses) text += line_of(pose, kDigits);
  return pack_text(text);
}

}  // namespace rayfield::formats
