#include <cmath>

#include "rayfield/formats/log_info.h"
#include "rayfield/formats/rig_proposal.h"
#include "rayfield/formats/sensor_log.h"
#include "tests/fuzz/memory_file.h"

namespace {

/// The promises of read_log() on what it delivers.
struct Checker : rayfield::SensorSink {
  double last_imu_s = -1;  // stamps count from 1970
  void imu(const rayfield::ImuSample& sample) override {
    if (!sample.angular_velocity_rad_s.allFinite() || sample.time_s <= last_imu_s) std::abort();
    last_imu_s = sample.time_s;
  }
  void lidar(const rayfield::LidarScan& scan) override {
    if (scan.direction.size() != scan.range_m.size() || scan.time_offset_s.size() != scan.range_m.size()) std::abort();
    for (const float range : scan.range_m) {
      if (std::isfinite(range) && (range < 0.2F || range > 40.0F)) std::abort();
    }
  }
};

}  // namespace

/// Whatever the bytes: an error, or messages that keep the promises; memory bounded by the limits.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const rayfield::fuzz::MemoryFile kFile;
  kFile.set(data, size);
  rayfield::Rig rig;
  rig.spinner = rayfield::Rig::Spinner();
  rig.gps = rayfield::Rig::Gps();
  rayfield::formats::LogOptions options;
  options.require_lidar = false;
  options.require_imu = false;
  options.bag.max_chunk_bytes = std::uint64_t{8} << 20;
  options.bag.max_message_bytes = std::uint64_t{8} << 20;
  Checker checker;
  const auto report = rayfield::formats::read_log(kFile.path(), rig, checker, options);
  if (report) (void)report->warnings();
  const auto info = rayfield::formats::inspect_log(kFile.path(), options);
  if (info) (void)rayfield::formats::propose_rig(*info);
  return 0;
}
