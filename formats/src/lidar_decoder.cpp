#include "lidar_decoder.h"

#include <cmath>
#include <limits>

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot read lidar";
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
/// A sweep longer than this is no sweep: its times are wrong.
constexpr double kLongestSweep_s = 10.0;
/// Under no_return = max_range, ranges this close to it count as none: cartesian points round.
constexpr double kMaxRangeShare = 1.0 - 1e-4;

}  // namespace

/// A raw range after REP 117 and the rig's limits, counted.
float LidarDecoder::classified(float range_m) {
  ++counts_.points;
  if (range_m == 0.0F) ++counts_.zeros;
  const double max_m = lidar_.max_range_m;
  const bool none = lidar_.no_return == NoReturn::zero        ? range_m == 0.0F
                    : lidar_.no_return == NoReturn::max_range ? static_cast<double>(range_m) >= max_m * kMaxRangeShare
                                                              : false;
  if (none || static_cast<double>(range_m) > max_m) {
    ++counts_.no_returns;
    return kInfinity;
  }
  if (std::isnan(range_m) || (range_m < 0 && std::isfinite(range_m))) {
    ++counts_.invalid;
    return kNaN;
  }
  if (static_cast<double>(range_m) < lidar_.min_range_m) {
    ++counts_.too_close;
    return -kInfinity;
  }
  ++counts_.returns;
  return range_m;
}

DecodeState LidarDecoder::judged(const LidarPointCounts& before) const {
  const bool informative = counts_.returns > before.returns || counts_.no_returns > before.no_returns ||
                           counts_.too_close > before.too_close;
  return informative ? DecodeState::usable : DecodeState::invalid;
}

void LidarDecoder::use_pattern(const LaserScanView& view) {
  const std::size_t beams = view.beams();
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

Result<DecodeState> LidarDecoder::laser_scan(std::span<const std::byte> message, std::int64_t stamp_ns) {
  const std::optional<LaserScanView> view = decode_laser_scan(message);
  if (!view) return DecodeState::undecodable;
  const double sweep = std::abs(static_cast<double>(view->time_increment)) * static_cast<double>(view->beams());
  if (!std::isfinite(view->angle_min) || !std::isfinite(view->angle_increment) || !(sweep <= kLongestSweep_s)) {
    return DecodeState::invalid;
  }
  const double sensor_max_m = static_cast<double>(view->range_max);
  if (std::isfinite(sensor_max_m) && sensor_max_m > 0 && lidar_.max_range_m > sensor_max_m * 1.01) {
    return fail(ErrorCode::usage, kWhat, {},
                "the rig's max_range_m is larger than the range_max of the scans, and the space between would count "
                "as seen empty",
                "set max_range_m = " + std::to_string(view->range_max) + " or less");
  }
  use_pattern(*view);
  scan_.time_s = seconds_from_ns(stamp_ns);
  const LidarPointCounts before = counts_;
  for (std::size_t i = 0; i < view->beams(); ++i) {
    scan_.range_m[i] = classified(load<float>(view->ranges.data() + i * sizeof(float)));
  }
  // Some drivers leave intensities out, some send a different number: then there are none.
  scan_.intensity.clear();
  if (view->intensities.size() == view->ranges.size() && !view->ranges.empty()) {
    scan_.intensity.resize(view->beams());
    std::memcpy(scan_.intensity.data(), view->intensities.data(), view->intensities.size());
  }
  return judged(before);
}

Result<DecodeState> LidarDecoder::point_cloud2(std::span<const std::byte> message, std::int64_t stamp_ns) {
  const std::optional<PointCloud2View> cloud = decode_point_cloud2(message);
  if (!cloud) return DecodeState::undecodable;
  if (cloud->big_endian) return fail(ErrorCode::bad_input, kWhat, {}, "big-endian point clouds are not supported");
  const PointFieldView* x = cloud->find("x");
  const PointFieldView* y = cloud->find("y");
  const PointFieldView* z = cloud->find("z");
  if (x == nullptr || y == nullptr || z == nullptr) {
    return fail(ErrorCode::bad_input, kWhat, {}, "the point clouds have no fields x, y and z");
  }
  const PointFieldView* intensity = cloud->find("intensity");
  if (intensity == nullptr) intensity = cloud->find("reflectivity");
  RAYFIELD_ASSIGN(const PointTime time, PointTime::find(*cloud));
  has_pattern_ = false;
  scan_.time_s = seconds_from_ns(stamp_ns);
  scan_.direction.clear(), scan_.range_m.clear(), scan_.time_offset_s.clear(), scan_.intensity.clear();
  const LidarPointCounts before = counts_;
  for (std::uint32_t row = 0; row < cloud->height; ++row) {
    const std::byte* point = cloud->data.data() + std::size_t{row} * cloud->row_step;
    for (std::uint32_t column = 0; column < cloud->width; ++column, point += cloud->point_step) {
      const Eigen::Vector3d p(point_value(point, *x), point_value(point, *y), point_value(point, *z));
      const double offset_s = time.offset_s(point, stamp_ns);
      const double range_m = p.norm();
      // Drivers write points without a return as NaN or at the origin; their direction is gone.
      if (range_m == 0.0) {
        ++counts_.points, ++counts_.zeros, ++counts_.without_direction;
        continue;
      }
      if (!std::isfinite(range_m) || !(std::abs(offset_s) <= kLongestSweep_s)) {
        ++counts_.points, ++counts_.invalid;
        continue;
      }
      scan_.direction.push_back((p / range_m).cast<float>());
      scan_.range_m.push_back(classified(static_cast<float>(range_m)));
      scan_.time_offset_s.push_back(static_cast<float>(offset_s));
      if (intensity != nullptr) scan_.intensity.push_back(static_cast<float>(point_value(point, *intensity)));
    }
  }
  return judged(before);
}

}  // namespace rayfield::formats
