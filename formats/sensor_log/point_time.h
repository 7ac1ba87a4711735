#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/rosbag/point_cloud2.h"
#include "rayfield/core/result.h"

namespace rayfield::formats {

/// Time of each point of a cloud relative to the stamp of its message.
class PointTime {
 public:
  /// Finds the field that carries time per point (time, t, timestamp, offset_time and the like; docs/rosbag.md) and
  /// its unit. Errors: bad_input where the cloud has none.
  static Result<PointTime> find(const PointCloud2View& cloud, std::int64_t stamp_ns);
  /// Seconds after the stamp.
  double offset_s(const std::byte* point) const { return (field_.value(point) - base_) * factor_ - rest_s_; }

 private:
  PointFieldView field_;
  double base_ = 0, factor_ = 1, rest_s_ = 0;
};

}  // namespace rayfield::formats
