#include "libslam/input/read_ahead.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace rayfield::slam {
namespace {

// Writes down what comes, by kind and time.
class Notes : public SensorSink {
 public:
  void imu(const ImuSample& s) override { note('i', s.time_s); }
  void gps(const GpsFix& f) override { note('g', f.time_s); }
  void spinner(const SpinnerAngle& a) override { note('s', a.time_s); }
  void lidar(const LidarScan& s) override { note('l', s.time_s), points += s.range_m.size(); }
  std::vector<std::pair<char, double>> seen;
  std::size_t points = 0, throw_at = static_cast<std::size_t>(-1);

 private:
  void note(char kind, double time) {
    if (seen.size() == throw_at) throw std::runtime_error("enough");
    seen.emplace_back(kind, time);
  }
};

// A drive's messages in turn; more than fit into the queue.
Result<void> drive(SensorSink& sink) {
  LidarScan scan;
  scan.direction.assign(5000, Eigen::Vector3f::UnitX()), scan.range_m.assign(5000, 2.0F);
  scan.time_offset_s.assign(5000, 0.0F);
  for (int k = 0; k < 20000; ++k) {
    ImuSample imu;
    imu.time_s = k;
    sink.imu(imu);
    if (k % 10 == 0) sink.spinner({k + 0.1, 0.0});
    if (k % 50 == 0) {
      GpsFix fix;
      fix.time_s = k + 0.2;
      sink.gps(fix);
    }
    if (k % 100 == 0) scan.time_s = k + 0.3, sink.lidar(scan);
  }
  return {};
}

TEST(ReadAhead, DeliversTheSameInTheSameOrder) {
  Notes direct, alone, ahead;
  ASSERT_TRUE(drive(direct));
  ASSERT_TRUE(read_ahead(drive, alone, 1));
  ASSERT_TRUE(read_ahead(drive, ahead, 2));
  EXPECT_EQ(alone.seen, direct.seen);
  EXPECT_EQ(ahead.seen, direct.seen);
  EXPECT_EQ(ahead.points, direct.points);
}

TEST(ReadAhead, PassesOnWhyReadingEnded) {
  Notes notes;
  const auto failing = [](SensorSink& sink) -> Result<void> {
    sink.spinner({1.0, 0.0});
    return fail(ErrorCode::resources, "cannot read", "x.bag, byte 7", "the disk is gone");
  };
  const Result<void> failed = read_ahead(failing, notes, 2);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().where, "x.bag, byte 7");
  EXPECT_EQ(notes.seen.size(), 1u);  // what came before is delivered
  const auto throwing = [](SensorSink&) -> Result<void> { throw std::runtime_error("broken"); };
  const Result<void> thrown = read_ahead(throwing, notes, 2);
  ASSERT_FALSE(thrown);
  EXPECT_EQ(thrown.error().code, ErrorCode::internal);
}

TEST(ReadAhead, EndsItsThreadWhenTheSinkThrows) {
  Notes notes;
  notes.throw_at = 100;
  EXPECT_THROW((void)read_ahead(drive, notes, 2), std::runtime_error);
  EXPECT_EQ(notes.seen.size(), 100u);
}

}  // namespace
}  // namespace rayfield::slam
