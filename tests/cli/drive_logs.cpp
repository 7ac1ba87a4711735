#include "tests/cli/drive_logs.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "rayfield/formats/formats.h"

namespace rayfield::test {
namespace {

// Passes messages on to a writer, damaged; a SensorSink cannot return an error, so the first one is kept.
class Damager : public SensorSink {
 public:
  Damager(formats::SensorLogWriter& writer, const Damage& damage) : writer_(writer), damage_(damage) {}
  void imu(const ImuSample& sample) override {
    if (ImuSample copy = sample; keeps(damage_.imu, copy)) expect(writer_.imu(copy));
  }
  void gps(const GpsFix& fix) override {
    if (GpsFix copy = fix; keeps(damage_.gps, copy)) expect(writer_.gps(copy));
  }
  void spinner(const SpinnerAngle& angle) override {
    if (SpinnerAngle copy = angle; keeps(damage_.spinner, copy)) expect(writer_.spinner(copy, 3.14));
  }
  void lidar(const LidarScan& scan) override {
    if (LidarScan copy = scan; keeps(damage_.lidar, copy))
      expect(writer_.scan(copy.time_s, pattern_of(scan), copy.range_m, copy.intensity));
  }

 private:
  template <class Message>
  bool keeps(const std::function<bool(Message&, double)>& damage, Message& message) {
    if (!started_) first_s_ = message.time_s, started_ = true;
    return !damage || damage(message, message.time_s - first_s_);
  }
  static formats::ScanPattern pattern_of(const LidarScan& scan) {
    const auto angle = [&](std::size_t i) {
      return std::atan2(static_cast<double>(scan.direction[i].y()), static_cast<double>(scan.direction[i].x()));
    };
    formats::ScanPattern pattern;
    pattern.beams = scan.range_m.size();
    pattern.angle_min_rad = angle(0);
    pattern.angle_increment_rad = angle(1) - angle(0);
    pattern.time_increment_s = static_cast<double>(scan.time_offset_s[1]);
    pattern.scan_time_s = 0.01;
    pattern.range_min_m = 0.1, pattern.range_max_m = 40;
    return pattern;
  }
  static void expect(const Result<void>& written) { ASSERT_TRUE(written) << written.error().line(); }

  formats::SensorLogWriter& writer_;
  const Damage& damage_;
  bool started_ = false;
  double first_s_ = 0;
};

}  // namespace

SimulatedLog simulate_drive(const Folder& folder, const std::string& lidar) {
  const std::string site = small_site(folder, (lidar.empty() ? "" : "[lidar]\n" + lidar + "\n") + kLateDate);
  const Outcome run = rayfield({"simulate", site, "-o", folder.path("drive"), "--no-rays", "-q"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return {folder.path("drive/2021-07-01/scan.bag"), folder.path("drive/2021-07-01/rig.toml")};
}

Damage other_stamps(const std::function<double(double, double)>& stamp) {
  const auto move = [stamp](auto& message, double elapsed_s) {
    message.time_s = stamp(message.time_s, elapsed_s);
    return true;
  };
  return {move, move, move, move};
}

std::string write_damaged(const SimulatedLog& from, const std::string& to, const Damage& damage) {
  const auto rig = formats::read_rig(from.rig);
  EXPECT_TRUE(rig) << rig.error().line();
  auto writer = formats::SensorLogWriter::create(to, *rig);
  EXPECT_TRUE(writer) << writer.error().line();
  Damager damager(*writer, damage);
  const auto report = formats::read_log(from.bag, *rig, damager);
  EXPECT_TRUE(report) << report.error().line();
  const auto closed = writer->close();
  EXPECT_TRUE(closed) << closed.error().line();
  return to;
}

std::string write_raw_packets(const std::string& to) {
  auto bag = formats::BagWriter::create(to);
  EXPECT_TRUE(bag) << bag.error().line();
  const std::uint32_t packets = bag->add_connection("/os/lidar_packets", "ouster_ros/PacketMsg",
                                                    "4f7b5949e76f86d01e96b0e33ba9b5e3", "uint8[] buf");
  const std::array<std::byte, 4> empty_buffer{};
  for (std::int64_t i = 0; i < 10; ++i)
    EXPECT_TRUE(bag->write(packets, 1'600'000'000'000'000'000 + i * 10'000'000, empty_buffer));
  EXPECT_TRUE(bag->close());
  return to;
}

}  // namespace rayfield::test
