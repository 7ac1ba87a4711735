#include "formats/sensor_log/lidar_decoder.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "formats/sensor_log/point_time.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot read lidar";
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
/// A sweep longer than this is not a sweep: its times are wrong.
constexpr double kLongestSweep_s = 10.0;

/// A field may hold anything, NaN too.
std::uint16_t ring_number(double value) {
  return value > 0 ? static_cast<std::uint16_t>(std::min(value, 65535.0)) : std::uint16_t{0};
}

}  // namespace

/// A raw range after REP 117 and the rig's limits, counted.
float LidarDecoder::classify(float range_m) {
  ++counts_.points;
  if (range_m == 0.0F) ++counts_.zeros;
  switch (kind_of_range(range_m, lidar_)) {
    case RangeKind::none:
      ++counts_.no_returns;
      return kInfinity;
    case RangeKind::invalid:
      ++counts_.invalid;
      return kNaN;
    case RangeKind::too_close:
      ++counts_.too_close;
      return -kInfinity;
    case RangeKind::returned:
      break;
  }
  ++counts_.returns;
  return range_m;
}

DecodeState LidarDecoder::state_since(const LidarPointCounts& before) const {
  const bool informative = counts_.returns > before.returns || counts_.no_returns > before.no_returns ||
                           counts_.too_close > before.too_close;
  return informative ? DecodeState::usable : DecodeState::invalid;
}

void LidarDecoder::use_pattern(const PlaneScanView& view, std::size_t beams) {
  scan_.range_m.resize(beams);
  if (has_pattern_ && scan_.direction.size() == beams && angle_min_ == view.angle_min &&
      angle_increment_ == view.angle_increment && time_increment_ == view.time_increment) {
    return;
  }
  scan_.direction.resize(beams);
  scan_.time_offset_s.resize(beams);
  for (std::size_t i = 0; i < beams; ++i) {
    const double beam = static_cast<double>(i);
    const double angle = static_cast<double>(view.angle_min) + beam * static_cast<double>(view.angle_increment);
    scan_.direction[i] = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0).cast<float>();
    scan_.time_offset_s[i] = static_cast<float>(beam * static_cast<double>(view.time_increment));
  }
  has_pattern_ = true;
  angle_min_ = view.angle_min, angle_increment_ = view.angle_increment, time_increment_ = view.time_increment;
}

Result<DecodeState> LidarDecoder::begin_plane_scan(const PlaneScanView& view, std::size_t beams,
                                                   std::int64_t stamp_ns) {
  const double sweep = std::abs(static_cast<double>(view.time_increment)) * static_cast<double>(beams);
  if (!std::isfinite(view.angle_min) || !std::isfinite(view.angle_increment) || !(sweep <= kLongestSweep_s)) {
    return DecodeState::invalid;
  }
  const double sensor_max_m = static_cast<double>(view.range_max);
  if (std::isfinite(sensor_max_m) && sensor_max_m > 0 && lidar_.max_range_m > sensor_max_m * 1.01) {
    return fail(ErrorCode::usage, kWhat, {},
                "the rig's max_range_m is larger than the range_max of the scans, and the space between would count "
                "as seen empty",
                "set max_range_m = " + std::to_string(view.range_max) + " or less");
  }
  use_pattern(view, beams);
  scan_.time_s = seconds_from_ns(stamp_ns);
  scan_.intensity.clear();
  return DecodeState::usable;
}

Result<DecodeState> LidarDecoder::laser_scan(std::span<const std::byte> message, std::int64_t stamp_ns) {
  const std::optional<LaserScanView> view = decode_laser_scan(message);
  if (!view) return DecodeState::undecodable;
  RAYFIELD_ASSIGN(const DecodeState begun, begin_plane_scan(*view, view->beams(), stamp_ns));
  if (begun != DecodeState::usable) return begun;
  const LidarPointCounts before = counts_;
  for (std::size_t i = 0; i < view->beams(); ++i) {
    scan_.range_m[i] = classify(load<float>(view->ranges.data() + i * sizeof(float)));
  }
  // Some drivers leave intensities out, some send a different number: then there are none.
  if (view->intensities.size() == view->ranges.size() && !view->ranges.empty()) {
    scan_.intensity.resize(view->beams());
    std::memcpy(scan_.intensity.data(), view->intensities.data(), view->intensities.size());
  }
  return state_since(before);
}

/// A beam without echoes has met nothing.
Result<DecodeState> LidarDecoder::multi_echo_laser_scan(std::span<const std::byte> message, std::int64_t stamp_ns) {
  const std::optional<MultiEchoLaserScanView> view = decode_multi_echo_laser_scan(message);
  if (!view) return DecodeState::undecodable;
  RAYFIELD_ASSIGN(const DecodeState begun, begin_plane_scan(*view, view->beams(), stamp_ns));
  if (begun != DecodeState::usable) return begun;
  const auto same_size = [](const auto& ranges, const auto& strengths) { return ranges.size() == strengths.size(); };
  const bool has_intensity = std::equal(view->ranges.begin(), view->ranges.end(), view->intensities.begin(),
                                        view->intensities.end(), same_size);
  if (has_intensity) scan_.intensity.resize(view->beams());
  const LidarPointCounts before = counts_;
  for (std::size_t i = 0; i < view->beams(); ++i) {
    echoes_.resize(view->ranges[i].size() / sizeof(float));
    if (!echoes_.empty()) std::memcpy(echoes_.data(), view->ranges[i].data(), view->ranges[i].size());
    const std::optional<FirstEcho> first = first_echo(echoes_, lidar_);
    scan_.range_m[i] = classify(first ? echoes_[first->index] : kInfinity);
    if (first) counts_.later_echoes += first->later;
    if (has_intensity)
      scan_.intensity[i] = first ? load<float>(view->intensities[i].data() + first->index * sizeof(float)) : 0.0F;
  }
  return state_since(before);
}

/// Every point that has a time. Returns whether they have rings.
Result<bool> LidarDecoder::collect_points(const PointCloud2View& cloud, std::int64_t stamp_ns) {
  const PointFieldView* x = cloud.find("x");
  const PointFieldView* y = cloud.find("y");
  const PointFieldView* z = cloud.find("z");
  if (x == nullptr || y == nullptr || z == nullptr) {
    return fail(ErrorCode::bad_input, kWhat, {}, "the point clouds have no fields x, y and z");
  }
  const PointFieldView* intensity = cloud.find("intensity");
  if (intensity == nullptr) intensity = cloud.find("reflectivity");
  const PointFieldView* ring = cloud.find("ring");
  if (ring == nullptr) ring = cloud.find("channel");
  RAYFIELD_ASSIGN(const PointTime time, PointTime::find(cloud, stamp_ns));
  has_intensity_ = intensity != nullptr;
  points_.clear();
  for (std::uint32_t row = 0; row < cloud.height; ++row) {
    const std::byte* point = cloud.data.data() + std::size_t{row} * cloud.row_step;
    for (std::uint32_t column = 0; column < cloud.width; ++column, point += cloud.point_step) {
      const Eigen::Vector3d p(x->value(point), y->value(point), z->value(point));
      const double offset_s = time.offset_s(point);
      const double range_m = p.norm();
      const bool placed = std::isfinite(range_m) && range_m > 0;
      const bool timed = std::abs(offset_s) <= kLongestSweep_s;
      if (!timed || (!placed && !is_gap(range_m))) {
        ++counts_.points, ++(range_m == 0 && timed ? counts_.without_direction : counts_.invalid);
        counts_.zeros += range_m == 0;
        continue;
      }
      CloudPoint& taken = points_.emplace_back();
      taken.ring = ring != nullptr    ? ring_number(ring->value(point))
                   : cloud.height > 1 ? static_cast<std::uint16_t>(row)
                                      : std::uint16_t{0};
      taken.time_offset_s = static_cast<float>(offset_s);
      if (placed) taken.direction = (p / range_m).cast<float>();
      taken.range_m = static_cast<float>(range_m);
      if (has_intensity_) taken.intensity = static_cast<float>(intensity->value(point));
    }
  }
  return ring != nullptr || cloud.height > 1;
}

/// Shots without a return come in two kinds: those with a place count by their range, those without (gaps) get their
/// direction from the other beams once the whole sweep is known.
Result<DecodeState> LidarDecoder::point_cloud2(std::span<const std::byte> message, std::int64_t stamp_ns) {
  const std::optional<PointCloud2View> cloud = decode_point_cloud2(message);
  if (!cloud) return DecodeState::undecodable;
  if (cloud->big_endian) return fail(ErrorCode::bad_input, kWhat, {}, "big-endian point clouds are not supported");
  const LidarPointCounts before = counts_;
  RAYFIELD_ASSIGN(const bool has_rings, collect_points(*cloud, stamp_ns));
  counts_.later_echoes += keep_first_echoes(points_, has_rings, lidar_);
  has_pattern_ = false;
  scan_.time_s = seconds_from_ns(stamp_ns);
  scan_.direction.clear(), scan_.range_m.clear(), scan_.time_offset_s.clear(), scan_.intensity.clear();
  shots_.clear(), gaps_.clear();
  for (const CloudPoint& point : points_) {
    if (point.placed())
      shots_.push_back({point.ring, point.time_offset_s, point.direction});
    else
      gaps_.push_back({scan_.range_m.size(), point.ring, point.range_m == 0});
    scan_.direction.push_back(point.direction);
    scan_.range_m.push_back(point.placed() ? classify(point.range_m) : kInfinity);
    scan_.time_offset_s.push_back(point.time_offset_s);
    if (has_intensity_) scan_.intensity.push_back(point.intensity);
  }
  fill_gaps();
  return state_since(before);
}

/// True where a cloud writes nothing like this instead of a point when nothing came back: there is no infinite point.
bool LidarDecoder::is_gap(double range_m) const {
  return lidar_.no_return == NoReturn::infinity ? !std::isfinite(range_m)
                                                : lidar_.no_return == NoReturn::zero && range_m == 0;
}

/// Gives the gaps of a cloud their directions back (docs/rosbag.md); those that stay unknown are left out.
void LidarDecoder::fill_gaps() {
  if (gaps_.empty()) return;
  beams_.learn(shots_);
  std::vector<std::uint8_t> drop(scan_.range_m.size(), 0);
  for (const Gap& gap : gaps_) {
    ++counts_.points;
    counts_.zeros += gap.at_origin;
    const std::optional<Eigen::Vector3f> direction = beams_.direction(gap.ring, scan_.time_offset_s[gap.index]);
    if (direction) {
      scan_.direction[gap.index] = *direction;
      ++counts_.no_returns, ++counts_.restored;
    } else {
      drop[gap.index] = 1;
      ++(gap.at_origin ? counts_.without_direction : counts_.invalid);
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < drop.size(); ++i) {
    if (drop[i] != 0) continue;
    scan_.direction[kept] = scan_.direction[i];
    scan_.range_m[kept] = scan_.range_m[i];
    scan_.time_offset_s[kept] = scan_.time_offset_s[i];
    if (!scan_.intensity.empty()) scan_.intensity[kept] = scan_.intensity[i];
    ++kept;
  }
  scan_.direction.resize(kept), scan_.range_m.resize(kept), scan_.time_offset_s.resize(kept);
  if (!scan_.intensity.empty()) scan_.intensity.resize(kept);
}

}  // namespace rayfield::formats
