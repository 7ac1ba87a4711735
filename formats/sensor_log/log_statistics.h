#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/rosbag/point_cloud2.h"
#include "formats/rosbag/ros_decode.h"
#include "formats/sensor_log/stationary_detector.h"
#include "rayfield/formats/log_info.h"

namespace rayfield::formats {

/// Regularity of a topic's stamps, in constant memory.
class StampStatistics {
 public:
  /// `log_clock_ns`: the time that passed in the recording, jumps of its clock taken out.
  void add(std::int64_t stamp_ns, std::int64_t log_clock_ns, const LogOptions& options);
  void report(TopicInfo& topic) const;

 private:
  double usual_interval_s() const;

  static constexpr std::size_t kIntervals = 1000;
  static constexpr std::size_t kLearning = 20;
  std::vector<double> intervals_s_;  // the first ones, for the median
  std::uint64_t messages_ = 0, backwards_ = 0, repeated_ = 0, gaps_ = 0, clock_jumps_ = 0;
  std::int64_t first_ns_ = 0, last_ns_ = 0, latest_ns_ = 0, last_clock_ns_ = 0;
  double longest_gap_s_ = 0;
  double usual_s_ = 0;  // known after kLearning intervals
};

class LidarStatistics {
 public:
  explicit LidarStatistics(std::string topic) { info_.topic = std::move(topic); }
  void add(const LaserScanView& scan);
  void add(const MultiEchoLaserScanView& scan);
  void add(const PointCloud2View& cloud);
  LidarInfo report() const;

 private:
  void add_range(double range_m);
  void add_limits(const PlaneScanView& scan);
  LidarInfo info_;
  std::uint64_t messages_ = 0, looked_at_ = 0;
};

class ImuStatistics {
 public:
  explicit ImuStatistics(std::string topic) { info_.topic = std::move(topic); }
  void add(const ImuSample& sample);
  ImuInfo report() const;

 private:
  ImuInfo info_;
  double acceleration_sum_ = 0;
  std::uint64_t samples_ = 0;
};

class GpsStatistics {
 public:
  explicit GpsStatistics(std::string topic) { info_.topic = std::move(topic); }
  void add(const GpsFix& fix);
  GpsInfo report() const { return info_; }

 private:
  GpsInfo info_;
};

/// The joints of one JointState topic; at most 32 are followed.
class JointStatistics {
 public:
  explicit JointStatistics(std::string topic) : topic_(std::move(topic)) {}
  void add(const JointStateView& state, double time_s);
  std::vector<JointInfo> report() const;

 private:
  struct Joint {
    std::string name;
    double last_rad = 0, travelled_rad = 0;
    StationaryDetector stationary;
  };
  std::string topic_;
  std::vector<Joint> joints_;
};

}  // namespace rayfield::formats
