#include "rayfield/formats/las_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/las/las_file.h"
#include "formats/las/point_filter.h"
#include "formats/las/sensor_positions.h"
#include "formats/las/time_match.h"
#include "rayfield/core/median.h"

namespace rayfield::formats {
namespace {

constexpr double kMaxCoordinate_m = 1e8;  // as of other clouds
constexpr double kLongestRay_m = 2000;    // no lidar on a vehicle reaches further
constexpr std::uint64_t kSamples = 1024;

// Points that are no end of a ray, beyond what PointFilter leaves out.
struct LeftOut {
  std::uint64_t outside = 0, in_gap = 0, too_far = 0, too_long = 0, no_length = 0;
};

}  // namespace

struct LasReader::Impl {
  Impl(LasFile las, std::shared_ptr<const TrajectoryFile> given, const LasReadOptions& read_options)
      : file(std::move(las)),
        trajectory(std::move(given)),
        options(read_options),
        track(trajectory, read_options.lever_arm_m, read_options.max_gap_s, read_options.tolerance_s) {}

  LasFile file;
  std::shared_ptr<const TrajectoryFile> trajectory;
  LasReadOptions options;
  SensorPositions track;
  TimeMatch match;
  std::uint64_t next = 0;  // point
  PointFilter filter;
  LeftOut left_out;

  Result<void> match_clocks();
  Result<void> check_distance(const std::vector<LasPoint>& samples);
  void add(const LasPoint& point, RayBatch& batch);
};

// Looks at points from all over the file, however large it is.
Result<void> LasReader::Impl::match_clocks() {
  const std::uint64_t points = file.point_count();
  if (points == 0) return fail(ErrorCode::bad_input, kLasWhat, file.path(), "it holds no points", "export it again");
  const std::uint64_t count = std::min(points, kSamples);
  std::vector<LasPoint> samples;
  std::vector<double> times;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t index =
        count < 2 ? 0
                  : static_cast<std::uint64_t>(static_cast<double>(points - 1) * static_cast<double>(i) /
                                               static_cast<double>(count - 1));
    RAYFIELD_ASSIGN(LasPoint point, file.point(std::min(index, points - 1)));
    point.gps_time_s += options.time_offset_s;
    times.push_back(point.gps_time_s);
    samples.push_back(point);
  }
  const TimeSpan span{trajectory->poses.front().time_s, trajectory->poses.back().time_s};
  auto found = match_times(times, file.header().says_adjusted_gps_time(), span, options.tolerance_s);
  if (!found) {
    found.error().where = file.path();
    return tl::make_unexpected(std::move(found).error());
  }
  match = std::move(*found);
  return check_distance(samples);
}

/// A trajectory in another CRS than the points gives rays of kilometres, each through thousands of tiles.
Result<void> LasReader::Impl::check_distance(const std::vector<LasPoint>& samples) {
  std::vector<double> away_m;
  for (const LasPoint& point : samples) {
    Eigen::Vector3d origin;
    if (!std::isfinite(point.gps_time_s)) continue;
    if (track.at(match.trajectory_time(point.gps_time_s), origin) == SensorPositions::Place::found)
      away_m.push_back((point.position - origin).norm());
  }
  const double median_m = away_m.empty() ? 0 : median_of(away_m);
  if (median_m <= kLongestRay_m) return {};
  return fail(ErrorCode::bad_input, kLasWhat, file.path(),
              fmt::format("its points lie {:.0f} km from the trajectory at their times", median_m / 1000),
              "give both in one CRS, in metres");
}

void LasReader::Impl::add(const LasPoint& point, RayBatch& batch) {
  if (!filter.takes(point)) return;
  const double time_s = match.trajectory_time(point.gps_time_s + options.time_offset_s);
  Eigen::Vector3d origin;
  const SensorPositions::Place place = track.at(time_s, origin);
  std::uint64_t* reason = nullptr;
  if (place == SensorPositions::Place::outside) {
    reason = &left_out.outside;
  } else if (place == SensorPositions::Place::gap) {
    reason = &left_out.in_gap;
  } else if (!(std::max(point.position.cwiseAbs().maxCoeff(), origin.cwiseAbs().maxCoeff()) <= kMaxCoordinate_m)) {
    reason = &left_out.too_far;
  } else if (const double length_m = (point.position - origin).norm(); length_m == 0 || length_m > kLongestRay_m) {
    reason = length_m == 0 ? &left_out.no_length : &left_out.too_long;
  }
  if (reason != nullptr) {
    ++*reason;
    return;
  }
  // An intensity of 0 means no hit elsewhere.
  batch.push(origin, point.position, time_s + match.to_unix_s, std::max<std::uint16_t>(point.intensity, 1), true);
}

Result<void> LasReadOptions::validate() const {
  const auto bad = [](const char* key, const char* why) {
    return fail(ErrorCode::usage, "bad option for LAS clouds", key, why);
  };
  if (!lever_arm_m.allFinite()) return bad("lever_arm_m", "must be finite");
  if (!std::isfinite(time_offset_s)) return bad("time_offset_s", "must be finite");
  if (!(max_gap_s >= 0 && max_gap_s <= 60)) return bad("max_gap_s", "must be 0 to 60");
  if (!(tolerance_s >= 0 && tolerance_s <= 1)) return bad("tolerance_s", "must be 0 to 1");
  return {};
}

LasReader::LasReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LasReader::~LasReader() = default;

Result<std::unique_ptr<LasReader>> LasReader::open(const std::string& path,
                                                   std::shared_ptr<const TrajectoryFile> trajectory,
                                                   const LasReadOptions& options) {
  RAYFIELD_CHECK(options.validate());
  if (!trajectory || trajectory->poses.empty())
    return fail(ErrorCode::usage, kLasWhat, path, "without a trajectory nothing says where its rays began");
  if (trajectory->poses.size() < 2)
    return fail(ErrorCode::bad_input, kLasWhat, path, "its trajectory holds fewer than two poses",
                "give the path of its drive");
  if (!options.lever_arm_m.isZero(0) && !trajectory->has_orientation)
    return fail(ErrorCode::usage, kLasWhat, path, "a lever arm needs a trajectory with orientations",
                "give one with qx qy qz qw");
  RAYFIELD_ASSIGN(LasFile file, LasFile::open(path, {options.allow_truncated, options.allow_trailing}));
  auto impl = std::make_unique<Impl>(std::move(file), std::move(trajectory), options);
  RAYFIELD_CHECK(impl->match_clocks());
  return std::unique_ptr<LasReader>(new LasReader(std::move(impl)));
}

Result<std::size_t> LasReader::read(RayBatch& batch, std::size_t max_rays) {
  batch.clear();
  const LasHeader& header = impl_->file.header();
  const std::uint64_t points = impl_->file.point_count();
  try {
    batch.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(max_rays, points - impl_->next)));
    while (batch.size() < max_rays && impl_->next < points) {
      if (impl_->options.cancelled && impl_->options.cancelled())
        return fail(ErrorCode::interrupted, "interrupted", name(), "", "run the same command again");
      RAYFIELD_ASSIGN(const auto records, impl_->file.records(impl_->next, max_rays - batch.size()));
      for (std::size_t at = 0; at < records.size(); at += header.point_bytes)
        impl_->add(decode_las_point(&records[at], header), batch);
      impl_->next += records.size() / header.point_bytes;
    }
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::resources, kLasWhat, name(), "out of memory", "read fewer rays at a time");
  }
  return batch.size();
}

Result<bool> LasReader::rewind() {
  impl_->next = 0;
  impl_->filter = {};
  impl_->left_out = {};
  return true;
}

std::optional<std::uint64_t> LasReader::ray_count() const { return impl_->file.point_count(); }

std::string LasReader::name() const { return impl_->file.path(); }

std::vector<std::string> LasReader::warnings() const {
  std::vector<std::string> lines = impl_->file.notes();
  if (!impl_->match.has_date) lines.push_back("the times of cloud and trajectory have no date");
  for (std::string& line : impl_->filter.lines()) lines.push_back(std::move(line));
  const LeftOut& left_out = impl_->left_out;
  say_left_out(left_out.outside, "measured before or after the trajectory", lines);
  say_left_out(left_out.in_gap, "measured in gaps of the trajectory", lines);
  say_left_out(left_out.too_far, "with coordinates beyond 100000 km", lines);
  say_left_out(left_out.too_long, "further than 2 km from the sensor", lines);
  say_left_out(left_out.no_length, "at the sensor itself", lines);
  return lines;
}

std::optional<std::string> LasReader::crs() const { return impl_->file.crs().text; }

std::string LasReader::crs_name() const { return impl_->file.crs().name; }

std::vector<std::string> LasReader::notes() const {
  std::vector<std::string> lines = {impl_->match.text};
  const Eigen::Vector3d arm = impl_->options.lever_arm_m.array() + 0.0;  // no -0.000
  lines.push_back(arm.isZero(0)
                      ? std::string("rays begin on the trajectory itself")
                      : fmt::format("rays begin {:.3f} {:.3f} {:.3f} m from the trajectory, in its body's frame",
                                    arm.x(), arm.y(), arm.z()));
  if (impl_->options.time_offset_s != 0)
    lines.push_back(fmt::format("{:+.6f} s are added to the points' times", impl_->options.time_offset_s));
  return lines;
}

}  // namespace rayfield::formats
