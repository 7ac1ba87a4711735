#include "rayfield/formats/sensor_log_writer.h"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "formats/io/number_type.h"
#include "formats/rosbag/ros_definitions.h"
#include "formats/rosbag/ros_encode.h"
#include "formats/rosbag/ros_header.h"

namespace rayfield::formats {
namespace {

constexpr const char* kWhat = "cannot write log";

/// A range after REP 117 in the convention of the rig.
float as_written(float range_m, NoReturn no_return, double max_range_m) {
  if (!(std::isinf(range_m) && range_m > 0)) return range_m;
  switch (no_return) {
    case NoReturn::zero:
      return 0.0F;
    case NoReturn::max_range:
      return static_cast<float>(max_range_m);
    case NoReturn::infinity:
      break;
  }
  return range_m;
}

void put_floats(std::span<const float> values, ByteBuilder& out) {
  out.put(static_cast<std::uint32_t>(values.size()));
  out.raw(std::as_bytes(values));
}

void put_point_field(std::string_view name, std::uint32_t offset, NumberType type, ByteBuilder& out) {
  out.text(name), out.put(offset), out.put(static_cast<std::uint8_t>(type)), out.put(std::uint32_t{1});
}

Result<void> check_sizes(const ScanPattern& pattern, std::size_t ranges, std::size_t intensities) {
  if (ranges == pattern.beams && (intensities == 0 || intensities == pattern.beams)) return {};
  return fail(ErrorCode::usage, kWhat, "scan", "ranges or intensities are not as many as the beams");
}

/// Later echoes follow a return of their beam, in the order of points.
Result<void> check_later(const LidarScan& scan) {
  std::uint32_t last = 0;
  for (const LaterEcho& later : scan.later) {
    if (later.point >= scan.range_m.size() || later.point < last || !std::isfinite(scan.range_m[later.point]))
      return fail(ErrorCode::usage, kWhat, "later echoes", "they are out of order, or follow no return");
    last = later.point;
  }
  return {};
}

void put_pattern(const ScanPattern& pattern, ByteBuilder& out) {
  const double last = pattern.beams > 0 ? static_cast<double>(pattern.beams - 1) : 0.0;
  for (const double value :
       {pattern.angle_min_rad, pattern.angle_min_rad + last * pattern.angle_increment_rad, pattern.angle_increment_rad,
        pattern.time_increment_s, pattern.scan_time_s, pattern.range_min_m, pattern.range_max_m}) {
    out.put(static_cast<float>(value));
  }
}

/// sensor_msgs/LaserEcho[]: of each beam the first echo, if something came back, and the later ones.
void put_echoes(const LidarScan& scan, std::span<const float> first, float LaterEcho::*value, ByteBuilder& out) {
  out.put(static_cast<std::uint32_t>(first.size()));
  auto later = scan.later.begin();
  for (std::size_t i = 0; i < first.size(); ++i) {
    const auto begin = later;
    while (later != scan.later.end() && later->point == i) ++later;
    const bool nothing = std::isinf(scan.range_m[i]) && scan.range_m[i] > 0;
    out.put(static_cast<std::uint32_t>((nothing ? 0 : 1) + (later - begin)));
    if (!nothing) out.put(first[i]);
    for (auto echo = begin; echo != later; ++echo) out.put((*echo).*value);
  }
}

/// x y z intensity as float32, ring as uint16, time as float32.
constexpr std::uint32_t kPointStep = 4 * 4 + 2 + 4;

/// Where a point is written; NaN or zeros where the rig's convention cannot keep the direction.
Eigen::Vector3f written_point(const Eigen::Vector3f& direction, float range_m, const Rig::Lidar& lidar) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const float range = as_written(range_m, lidar.no_return, lidar.max_range_m);
  if (!std::isfinite(range)) return {kNan, kNan, kNan};
  return direction * range;
}

}  // namespace

struct SensorLogWriter::Impl {
  Impl(BagWriter writer, Rig a_rig) : bag(std::move(writer)), rig(std::move(a_rig)) {}

  struct Topic {
    std::uint32_t connection = 0;
    std::uint32_t seq = 0;
  };

  BagWriter bag;
  Rig rig;
  std::optional<Topic> imu, gps, spinner, lidar;
  ByteBuilder message;
  std::vector<float> ranges;

  /// The topic's connection, declared with its first message; the message buffer is empty afterwards.
  Topic& use(std::optional<Topic>& topic, const std::string& name, const RosDefinition& definition) {
    if (!topic) topic = Topic{bag.add_connection(name, definition.type, definition.md5sum, definition.text), 0};
    message.clear();
    return *topic;
  }
  Result<void> write(Topic& topic, double time_s) {
    ++topic.seq;
    return bag.write(topic.connection, ns_from_seconds(time_s), message.bytes());
  }
};

SensorLogWriter::SensorLogWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SensorLogWriter::SensorLogWriter(SensorLogWriter&&) noexcept = default;
SensorLogWriter& SensorLogWriter::operator=(SensorLogWriter&&) noexcept = default;
SensorLogWriter::~SensorLogWriter() = default;

Result<SensorLogWriter> SensorLogWriter::create(const std::string& path, const Rig& rig,
                                                const BagWriteOptions& options) {
  RAYFIELD_ASSIGN(BagWriter bag, BagWriter::create(path, options));
  return SensorLogWriter(std::make_unique<Impl>(std::move(bag), rig));
}

Result<void> SensorLogWriter::imu(const ImuSample& sample) {
  Impl::Topic& topic = impl_->use(impl_->imu, impl_->rig.imu.topic, imu_definition());
  encode_imu(sample, topic.seq, "imu", impl_->message);
  return impl_->write(topic, sample.time_s);
}

Result<void> SensorLogWriter::gps(const GpsFix& fix) {
  if (!impl_->rig.gps) return fail(ErrorCode::usage, kWhat, "gps", "the rig has no gps");
  Impl::Topic& topic = impl_->use(impl_->gps, impl_->rig.gps->topic, nav_sat_fix_definition());
  encode_nav_sat_fix(fix, topic.seq, "gps", impl_->message);
  return impl_->write(topic, fix.time_s);
}

Result<void> SensorLogWriter::spinner(const SpinnerAngle& angle, double rate_rad_s) {
  if (!impl_->rig.spinner) return fail(ErrorCode::usage, kWhat, "spinner", "the rig has no spinner");
  Impl::Topic& topic = impl_->use(impl_->spinner, impl_->rig.spinner->topic, joint_state_definition());
  encode_joint_state(angle, rate_rad_s, topic.seq, "spinner", impl_->rig.spinner->joint, impl_->message);
  return impl_->write(topic, angle.time_s);
}

Result<void> SensorLogWriter::scan(double time_s, const ScanPattern& pattern, std::span<const float> range_m,
                                   std::span<const float> intensity) {
  RAYFIELD_CHECK(check_sizes(pattern, range_m.size(), intensity.size()));
  Impl::Topic& topic = impl_->use(impl_->lidar, impl_->rig.lidar.topic, laser_scan_definition());
  ByteBuilder& out = impl_->message;
  put_ros_header(topic.seq, time_s, "lidar", out);
  put_pattern(pattern, out);
  impl_->ranges.assign(range_m.begin(), range_m.end());
  const Rig::Lidar& lidar = impl_->rig.lidar;
  for (float& range : impl_->ranges) range = as_written(range, lidar.no_return, lidar.max_range_m);
  put_floats(impl_->ranges, out);
  put_floats(intensity, out);
  return impl_->write(topic, time_s);
}

Result<void> SensorLogWriter::multi_echo_scan(const ScanPattern& pattern, const LidarScan& scan) {
  RAYFIELD_CHECK(check_sizes(pattern, scan.range_m.size(), scan.intensity.size()));
  RAYFIELD_CHECK(check_later(scan));
  Impl::Topic& topic = impl_->use(impl_->lidar, impl_->rig.lidar.topic, multi_echo_laser_scan_definition());
  ByteBuilder& out = impl_->message;
  put_ros_header(topic.seq, scan.time_s, "lidar", out);
  put_pattern(pattern, out);
  put_echoes(scan, scan.range_m, &LaterEcho::range_m, out);
  if (scan.intensity.empty())
    out.put(std::uint32_t{0});
  else
    put_echoes(scan, scan.intensity, &LaterEcho::intensity, out);
  return impl_->write(topic, scan.time_s);
}

/// The layout of the points is fixed (kPointStep), whatever the scan holds: missing columns are written as zeros.
Result<void> SensorLogWriter::points(const LidarScan& scan, std::span<const std::uint16_t> ring) {
  const std::size_t shots = scan.range_m.size(), count = shots + scan.later.size();
  if (scan.direction.size() != shots || scan.time_offset_s.size() != shots ||
      (!scan.intensity.empty() && scan.intensity.size() != shots) || (!ring.empty() && ring.size() != shots)) {
    return fail(ErrorCode::usage, kWhat, "points", "the columns of the scan differ in length");
  }
  RAYFIELD_CHECK(check_later(scan));
  if (count > (std::size_t{1} << 30) / kPointStep) return fail(ErrorCode::usage, kWhat, "points", "over 1 GiB");
  Impl::Topic& topic = impl_->use(impl_->lidar, impl_->rig.lidar.topic, point_cloud2_definition());
  ByteBuilder& out = impl_->message;
  put_ros_header(topic.seq, scan.time_s, "lidar", out);
  out.put(std::uint32_t{1}), out.put(static_cast<std::uint32_t>(count));
  out.put(std::uint32_t{6});
  put_point_field("x", 0, NumberType::f32, out);
  put_point_field("y", 4, NumberType::f32, out);
  put_point_field("z", 8, NumberType::f32, out);
  put_point_field("intensity", 12, NumberType::f32, out);
  put_point_field("ring", 16, NumberType::u16, out);
  put_point_field("time", 18, NumberType::f32, out);
  out.put(std::uint8_t{0}), out.put(kPointStep), out.put(static_cast<std::uint32_t>(count * kPointStep));
  out.put(static_cast<std::uint32_t>(count * kPointStep));
  bool dense = true;
  const auto put_point = [&](std::size_t shot, float range_m, float intensity) {
    const Eigen::Vector3f point = written_point(scan.direction[shot], range_m, impl_->rig.lidar);
    dense = dense && point.allFinite();
    out.put(point.x()), out.put(point.y()), out.put(point.z());
    out.put(intensity);
    out.put(ring.empty() ? std::uint16_t{0} : ring[shot]);
    out.put(scan.time_offset_s[shot]);
  };
  for (std::size_t i = 0; i < shots; ++i)
    put_point(i, scan.range_m[i], scan.intensity.empty() ? 0.0F : scan.intensity[i]);
  for (const LaterEcho& later : scan.later) put_point(later.point, later.range_m, later.intensity);
  out.put(static_cast<std::uint8_t>(dense));
  return impl_->write(topic, scan.time_s);
}

Result<void> SensorLogWriter::close() { return impl_->bag.close(); }

}  // namespace rayfield::formats
