#include "libslam/pipeline/log_odometry.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "libslam/gps/georeference.h"

namespace rayfield::slam {
namespace {

constexpr double kClockAgreement = 10.0;   // s by which a lidar stamp may differ from the IMU's newest
constexpr std::uint64_t kHeldScans = 100;  // scans kept until the first IMU sample comes
constexpr double kMinSpinnerTurn = 0.5;    // rad that a spinner must turn in a section

}  // namespace

LogOdometry::LogOdometry(const Rig& rig, const SensorOffsets& known, const SlamOptions& options, Progress& progress)
    : rig_(rig), known_(known), options_(options), progress_(progress), assembler_(new_assembler()) {}

std::unique_ptr<LidarAssembler> LogOdometry::new_assembler() const {
  return std::make_unique<LidarAssembler>(rig_, rig_.lidar_offset_s + known_.lidar_s, known_.spinner_rad);
}

// Accepts samples that follow the last one in time. A sample that does not is kept aside: if the next one follows it,
// the clock jumped or data are missing, and a new section begins; otherwise it was a stray stamp.
void LogOdometry::imu(const ImuSample& sample) {
  ++imu_count_;
  if (!std::isfinite(sample.time_s) || !sample.angular_velocity_rad_s.allFinite() ||
      !sample.linear_acceleration_m_s2.allFinite()) {
    ++imu_invalid_;
    return;
  }
  accel_sum_ += sample.linear_acceleration_m_s2.norm();
  if (!last_imu_) {
    accept(sample);
    return;
  }
  const auto follows = [this](const ImuSample& a, const ImuSample& b) {
    return b.time_s > a.time_s && b.time_s - a.time_s <= options_.max_imu_gap_s;
  };
  if (suspect_) {
    if (follows(*suspect_, sample) && !follows(*last_imu_, sample)) {  // the clock did jump, or data are missing
      const ImuSample first = *suspect_;
      end_section();
      accept(first);
      accept(sample);
      return;
    }
    ++imu_stray_;
    suspect_.reset();
  }
  if (follows(*last_imu_, sample))
    accept(sample);
  else if (sample.time_s <= last_imu_->time_s && sample.time_s > last_imu_->time_s - 1.0)
    ++imu_late_;
  else
    suspect_ = sample;
}

void LogOdometry::accept(const ImuSample& sample) {
  last_imu_ = sample;
  if (const std::optional<ImuSample> ready = spikes_.push(sample)) use(*ready);
}

void LogOdometry::use(const ImuSample& sample) {
  // A section begins when both sensors run.
  if (!odometry_ && first_lidar_s_ && sample.time_s >= *first_lidar_s_)
    odometry_ = std::make_unique<Odometry>(rig_, options_, sample.time_s);
  if (odometry_) odometry_->add(sample);
}

void LogOdometry::gps(const GpsFix& fix) {
  fixes_.push_back(fix);
  if (!rig_.gps || !odometry_ || !usable_fix(fix)) return;
  const Eigen::Vector3d geodetic(fix.latitude_deg, fix.longitude_deg, fix.height_m);
  if (!first_plane_) first_plane_.emplace(geodetic);
  odometry_->add_fix(fix.time_s + rig_.gps_offset_s - odometry_->imu().epoch_s(),
                     first_plane_->enu_from_geodetic(geodetic));
}

void LogOdometry::spinner(const SpinnerAngle& angle) {
  ++angles_;
  assembler_->add(angle);
}

void LogOdometry::lidar(const LidarScan& scan) {
  ++scans_;
  if (error_) return;
  const double time = scan.time_s + rig_.lidar_offset_s + known_.lidar_s;
  if (last_imu_ && !(std::abs(time - last_imu_->time_s) < kClockAgreement)) return;
  if (!first_lidar_s_) first_lidar_s_ = time;
  assembler_->add(scan);
  if (odometry_ || scans_ > kHeldScans) drain(false);
  progress_.advance(1);
  if (odometry_ && !error_) {
    if (const Result<void> result = odometry_->advance(false); !result) error_ = result.error();
    if (progress_.cancelled()) {
      error_ = Error{ErrorCode::interrupted, "stopped", "windowed registration", "by the user", ""};
    }
  }
}

void LogOdometry::drain(bool flush) {
  assembler_->drain(
      [this](const BodyScan& scan) {
        if (odometry_) odometry_->add(scan);
      },
      flush);
}

void LogOdometry::end_section() {
  if (const std::optional<ImuSample> last = spikes_.flush()) use(*last);
  drain(true);
  points_ += assembler_->counts().points, hits_ += assembler_->counts().hits;
  if (odometry_ && !error_) {
    ++sections_;
    Result<OdometryResult> result = odometry_->finish();
    const double length = result ? result->track.end_s() : 0;
    const double best = best_ ? best_->odometry.track.end_s() : 0;
    if (result && length > best) {
      dropped_s_ += best;
      best_ = LogSection{std::move(*result), odometry_->imu(), assembler_->counts()};
    } else {
      dropped_s_ += length;
      if (!result && result.error().code != ErrorCode::bad_input) error_ = result.error();
    }
  }
  odometry_.reset();
  assembler_ = new_assembler();
  first_lidar_s_.reset(), suspect_.reset(), last_imu_.reset();
}

tl::unexpected<Error> LogOdometry::no_section() const {
  const auto bad = [](std::string_view why, std::string_view next) {
    return fail(ErrorCode::bad_input, "cannot reconstruct the drive", "log", why, next);
  };
  if (imu_count_ == 0) return bad("it has no IMU data on " + rig_.imu.topic, "check imu.topic in the rig file");
  if (imu_invalid_ == imu_count_) return bad("every IMU sample is NaN", "check the IMU's driver");
  if (scans_ == 0) return bad("it has no lidar data on " + rig_.lidar.topic, "check lidar.topic in the rig file");
  if (points_ == 0) return bad("no lidar scan lies within 10 s of the IMU's clock", "check the clocks of both sensors");
  if (rig_.spinner && angles_ == 0)
    return bad("it has no spinner angles on " + rig_.spinner->topic, "check spinner.topic in the rig file");
  if (hits_ == 0)
    return bad("not one lidar point has a usable range", "check lidar.no_return and the range limits in the rig file");
  return bad(fmt::format("IMU and lidar run together without a gap for less than {:.0f} s", options_.window.length_s),
             "see `rayfield info` for gaps");
}

// Checks that the data of the longest section can be what they claim to be, and turns counts into warnings.
Result<LogSection> LogOdometry::finish() {
  end_section();
  if (error_) return tl::make_unexpected(*error_);
  if (!best_) return no_section();
  if (hits_ == 0) return no_section();
  const double mean_force = accel_sum_ / static_cast<double>(std::max<std::uint64_t>(1, imu_count_ - imu_invalid_));
  if (mean_force < 5 || mean_force > 15)
    return fail(ErrorCode::bad_input, "cannot reconstruct the drive", "IMU",
                fmt::format("its mean specific force is {:.2f} m/s² where 9.8 is expected", mean_force),
                "the accelerometer must be in m/s² with gravity included");
  if (rig_.spinner && best_->lidar.spinner_turn_rad < kMinSpinnerTurn)
    return fail(ErrorCode::bad_input, "cannot reconstruct the drive", "spinner " + rig_.spinner->topic,
                fmt::format("it turned by only {:.3f} rad during the drive", best_->lidar.spinner_turn_rad),
                "the spinner or its encoder is stuck");
  const auto warn = [this](std::uint64_t count, std::string_view what) {
    if (count > 0) warnings_.push_back(fmt::format("{} {}", count, what));
  };
  warn(imu_invalid_, "IMU samples that are not finite left out");
  warn(imu_late_, "IMU samples out of order left out");
  warn(imu_stray_, "IMU samples with stray time stamps left out");
  warn(spikes_.repaired(), "IMU samples with spikes replaced by the mean of their neighbours");
  warn(best_->lidar.late_scans, "lidar scans out of order left out");
  warn(best_->lidar.unusable_scans, "lidar scans with unequal columns or without a time left out");
  warn(best_->lidar.scans_without_angle, "lidar scans (or parts) without a spinner angle left out");
  if (sections_ > 1)
    warnings_.push_back(
        fmt::format("the log falls into {} sections (clock jumps or IMU gaps); the longest is used, {:.1f} s "
                    "of others are left out",
                    sections_, dropped_s_));
  return std::move(*best_);
}

}  // namespace rayfield::slam
