#include <gtest/gtest.h>

#include <cmath>

#include "rayfield/formats/log_info.h"
#include "rayfield/formats/ply_reader.h"
#include "rayfield/formats/ply_writer.h"
#include "rayfield/formats/rig_file.h"
#include "rayfield/formats/rig_proposal.h"
#include "rayfield/formats/sensor_log.h"
#include "rayfield/formats/sensor_log_writer.h"
#include "tests/formats/bag_bytes.h"

/// Cut at every byte and with flipped bits: an error with a line, or a report that accounts for what is missing, and
/// never anything in the output that the rules exclude. Run under the sanitizers this also watches every access.
namespace rayfield::formats {
namespace {

using bytes::TemporaryFile;

Rig spinning_rig() {
  Rig rig;
  rig.spinner = Rig::Spinner();
  rig.gps = Rig::Gps();
  return rig;
}

/// A bag of some 15 kB with every sensor in several chunks.
std::string small_bag(BagCompression compression) {
  const TemporaryFile file("");
  BagWriteOptions options;
  options.compression = compression;
  options.chunk_bytes = 4096;
  auto writer = SensorLogWriter::create(file.path(), spinning_rig(), options);
  const ScanPattern pattern{20, -1, 0.1, 1e-4, 0.05, 0.1, 40};
  for (int i = 0; i < 10; ++i) {
    const double t = 1549843200 + 0.05 * i;
    std::vector<float> ranges(20);
    for (std::size_t k = 0; k < 20; ++k)
      ranges[k] = k % 5 == 0 ? INFINITY : 2.0F + 0.37F * static_cast<float>(k * 7 % 11 + static_cast<std::size_t>(i));
    EXPECT_TRUE(writer->imu({t, {0.1, 0.2, 0.3}, {0, 0, 9.81}}));
    EXPECT_TRUE(writer->spinner({t, 0.1 * i}, 2.0));
    EXPECT_TRUE(writer->scan(t, pattern, ranges, {}));
    EXPECT_TRUE(writer->gps({t, -35, 138, 80, Eigen::Matrix3d::Identity(), 0, 2}));
  }
  EXPECT_TRUE(writer->close());
  return bytes::read_file(file.path());
}

/// Checks the promises of read_log() on everything that comes out.
struct Checker : SensorSink {
  std::uint64_t messages = 0;
  double last_imu_s = -bytes::kInfinity;
  void imu(const ImuSample& sample) override {
    ++messages;
    EXPECT_TRUE(sample.angular_velocity_rad_s.allFinite() && sample.linear_acceleration_m_s2.allFinite());
    EXPECT_GT(sample.time_s, last_imu_s);
    last_imu_s = sample.time_s;
  }
  void gps(const GpsFix& fix) override {
    ++messages;
    EXPECT_LE(std::abs(fix.latitude_deg), 90);
  }
  void spinner(const SpinnerAngle& angle) override {
    ++messages;
    EXPECT_TRUE(std::isfinite(angle.angle_rad));
  }
  void lidar(const LidarScan& scan) override {
    ++messages;
    ASSERT_EQ(scan.direction.size(), scan.range_m.size());
    ASSERT_EQ(scan.time_offset_s.size(), scan.range_m.size());
    for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
      const float range = scan.range_m[i];
      EXPECT_TRUE(std::isnan(range) || std::isinf(range) || (range >= 0.2F && range <= 40.0F));
      EXPECT_NEAR(scan.direction[i].norm(), 1.0F, 1e-5F);
      EXPECT_LE(std::abs(scan.time_offset_s[i]), 10.0F);
    }
  }
};

void expect_error_or_account(const TemporaryFile& file, std::uint64_t whole_messages, bool cut) {
  LogOptions options;
  options.require_imu = false;
  options.require_lidar = false;
  Checker checker;
  const auto report = read_log(file.path(), spinning_rig(), checker, options);
  if (!report) {
    EXPECT_NE(report.error().code, ErrorCode::internal);
    EXPECT_FALSE(report.error().line().empty());
    return;
  }
  EXPECT_LE(checker.messages, whole_messages);
  if (cut && checker.messages < whole_messages) {
    EXPECT_GT(report->bag.lost_bytes, 0U);
    EXPECT_FALSE(report->warnings().empty());
  }
  const auto info = inspect_log(file.path());
  ASSERT_TRUE(info) << info.error().line();
  EXPECT_FALSE(propose_rig(*info).empty());
}

class BagRobustness : public ::testing::TestWithParam<BagCompression> {};

TEST_P(BagRobustness, SurvivesACutAtEveryByte) {
  const std::string whole = small_bag(GetParam());
  const TemporaryFile file("");
  // Inside the 4096 bytes of the bag header nothing changes from byte to byte.
  for (std::size_t size = 0; size<whole.size(); size += size> 200 && size < 4000 ? 400 : 1) {
    file.write(whole.substr(0, size));
    expect_error_or_account(file, 40, true);
    if (HasFailure()) FAIL() << "cut at " << size;
  }
}

TEST_P(BagRobustness, SurvivesFlippedBits) {
  const std::string whole = small_bag(GetParam());
  const TemporaryFile file("");
  std::uint64_t state = 42;  // a fixed sequence: xorshift64
  const auto random = [&state] {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return state;
  };
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = whole;
    for (std::uint64_t flips = 1 + random() % 4; flips > 0; --flips) {
      // The padding of the bag header is of no interest.
      const std::size_t at = random() % 16 == 0 ? random() % 120 : 4117 + random() % (whole.size() - 4117);
      damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1U << (random() % 8)));
    }
    file.write(damaged);
    expect_error_or_account(file, 40, false);
    if (HasFailure()) FAIL() << "round " << round;
  }
}

std::string compression_name(const ::testing::TestParamInfo<BagCompression>& compression) {
  return compression.param == BagCompression::none ? "none" : compression.param == BagCompression::bz2 ? "bz2" : "lz4";
}

INSTANTIATE_TEST_SUITE_P(Compression, BagRobustness,
                         ::testing::Values(BagCompression::none, BagCompression::bz2, BagCompression::lz4),
                         compression_name);

std::string small_cloud() {
  const TemporaryFile file("", ".ply");
  auto writer = PlyWriter::create(file.path());
  RayBatch rays;
  for (int i = 0; i < 20; ++i) rays.push({1.0 * i, 2, 3}, {1.0 * i, 5, 4}, 100 + i, 50, i % 3 != 0);
  EXPECT_TRUE(writer->write(rays));
  EXPECT_TRUE(writer->close());
  return bytes::read_file(file.path());
}

void expect_error_or_sound_rays(const TemporaryFile& file) {
  PlyReadOptions options;
  options.allow_truncated = true;
  options.allow_trailing = true;
  auto reader = PlyReader::open(file.path(), options);
  if (!reader) {
    EXPECT_EQ(reader.error().code, ErrorCode::bad_input);
    return;
  }
  RayBatch batch;
  std::uint64_t rays = 0;
  for (;;) {
    const auto count = (*reader)->read(batch, 6);
    ASSERT_TRUE(count);
    if (*count == 0) break;
    rays += *count;
    for (std::size_t i = 0; i < *count; ++i) {
      EXPECT_TRUE(batch.origin[i].allFinite() && batch.end[i].allFinite() && std::isfinite(batch.time_s[i]));
    }
  }
  EXPECT_LE(rays, (*reader)->ray_count().value());
}

TEST(PlyRobustness, SurvivesACutAtEveryByte) {
  const std::string whole = small_cloud();
  const TemporaryFile file("", ".ply");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    file.write(whole.substr(0, size));
    EXPECT_FALSE(PlyReader::open(file.path())) << "a cut file was taken for whole at " << size;
    expect_error_or_sound_rays(file);
    if (HasFailure()) FAIL() << "cut at " << size;
  }
}

TEST(PlyRobustness, SurvivesFlippedBits) {
  const std::string whole = small_cloud();
  const TemporaryFile file("", ".ply");
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ static_cast<char>(1U << (bit % 8)));
    file.write(damaged);
    expect_error_or_sound_rays(file);
    if (HasFailure()) FAIL() << "bit " << bit;
  }
}

TEST(RigRobustness, SurvivesACutAtEveryByteAndFlippedBits) {
  const std::string whole = rig_text(spinning_rig());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto rig = parse_rig(whole.substr(0, size), "rig");
    EXPECT_TRUE(rig || rig.error().code == ErrorCode::usage);
  }
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ static_cast<char>(1U << (bit % 8)));
    const auto rig = parse_rig(damaged, "rig");
    EXPECT_TRUE(!rig || validate_rig(*rig));
  }
}

}  // namespace
}  // namespace rayfield::formats
