#include "rayfield/density/missing_rays.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "rayfield/core/median.h"

namespace rayfield::density {
namespace {

constexpr std::size_t kChunk = 65536;
constexpr double kLongestPeriodS = 0.01;   // slower beams do not make a scan line
constexpr double kPeriodTolerance = 0.25;  // of a period, for times that are whole periods apart
constexpr double kStepTolerance = 0.25;    // of the angle, for directions that are whole steps apart
constexpr double kMaxSpanRad = 0.6;        // of one gap
constexpr double kMinRegular = 0.6;        // share of successive times that must be one period apart

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// From a to b (units, `angle` apart) by the share f of the way, on the great circle.
Eigen::Vector3d turn_towards(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double angle, double f) {
  return (std::sin((1 - f) * angle) * a + std::sin(f * angle) * b) / std::sin(angle);
}

}  // namespace

Result<void> MissingRayOptions::validate() const { return check_option_ranges(*this, "bad option for missing rays"); }

Result<std::unique_ptr<MissingRaySource>> MissingRaySource::create(RaySource& source,
                                                                   const MissingRayOptions& options) {
  RAYFIELD_CHECK(options.validate());
  return std::unique_ptr<MissingRaySource>(new MissingRaySource(source, options));
}

void MissingRaySource::study_times() {
  studied_ = true;
  std::vector<double> steps;
  for (std::size_t i = 1; i < in_.size(); ++i) {
    const double step = in_.time_s[i] - in_.time_s[i - 1];
    if (step > 0 && step < kLongestPeriodS) steps.push_back(step);
    if (in_.hit[i] == 0) longest_m_ = std::max(longest_m_, (in_.end[i] - in_.origin[i]).norm());
  }
  if (steps.size() < 100 || steps.size() < in_.size() / 2) return;
  period_s_ = median_of(steps);
  const auto regular = std::count_if(
      steps.begin(), steps.end(), [this](double s) { return std::abs(s - period_s_) < kPeriodTolerance * period_s_; });
  usable_ = static_cast<double>(regular) > kMinRegular * static_cast<double>(in_.size()) && longest_m_ > 0;
}

void MissingRaySource::restore(const Last& now, double angle, int periods) {
  // Beams that a part of the vehicle stopped were no free rays. Their gaps go on above the horizon, where clouds keep
  // rays without a return, or reach down to where the ground would have sent them back.
  const double lowest = std::sin(options_.lowest_elevation_rad);
  int above = 0;
  for (int j = 1; j < periods; ++j) {
    const Eigen::Vector3d d = turn_towards(last_.direction, now.direction, angle, static_cast<double>(j) / periods);
    if (d.z() < lowest) return;
    if (d.z() >= 0) ++above;
  }
  if (above > options_.most_above) return;
  for (int j = 1; j < periods; ++j) {
    const double f = static_cast<double>(j) / periods;
    const Eigen::Vector3d d = turn_towards(last_.direction, now.direction, angle, f);
    if (d.z() >= 0) continue;
    const Eigen::Vector3d origin = (1 - f) * last_.origin + f * now.origin;
    out_.push(origin, origin + longest_m_ * d, last_.time_s + j * period_s_, 0, false);
    ++restored_;
  }
}

void MissingRaySource::process(std::size_t i) {
  const Eigen::Vector3d way = in_.end[i] - in_.origin[i];
  const double length = way.norm();
  Last now{in_.origin[i], length > 0 ? Eigen::Vector3d(way / length) : Eigen::Vector3d::Zero(), in_.time_s[i], 0,
           length > 0};
  if (in_.hit[i] == 0) longest_m_ = std::max(longest_m_, length);
  if (last_.valid && now.valid) {
    const double periods = (now.time_s - last_.time_s) / period_s_, k = std::round(periods);
    const double angle = angle_between(last_.direction, now.direction);
    const bool whole = std::abs(periods - k) < kPeriodTolerance;
    if (whole && k == 1) now.step_rad = angle;
    const double expected = k * last_.step_rad;
    if (whole && k >= 2 && k <= options_.longest_gap + 1 && last_.step_rad > 0 && angle > 1e-6 && angle < kMaxSpanRad &&
        std::abs(angle - expected) < kStepTolerance * expected) {
      now.step_rad = angle / k;
      restore(now, angle, static_cast<int>(k));
    }
  }
  out_.push(in_.origin[i], in_.end[i], in_.time_s[i], in_.intensity[i], in_.hit[i] != 0);
  last_ = now;
}

Result<void> MissingRaySource::refill() {
  out_.clear();
  out_at_ = 0;
  RAYFIELD_ASSIGN(const std::size_t got, source_.read(in_, kChunk));
  ended_ = got == 0;
  if (!studied_ && got > 0) study_times();
  if (!usable_) {
    for (std::size_t i = 0; i < got; ++i)
      if (in_.hit[i] == 0) misses_.add(in_.end[i] - in_.origin[i]);
    std::swap(in_, out_);
    if (ended_) out_.clear();
    return {};
  }
  for (std::size_t i = 0; i < got; ++i) process(i);
  return {};
}

Result<std::size_t> MissingRaySource::read(RayBatch& batch, std::size_t max_rays) {
  batch.clear();
  while (batch.size() < max_rays) {
    if (out_at_ == out_.size()) {
      if (ended_) break;
      RAYFIELD_CHECK(refill());
      continue;
    }
    const std::size_t i = out_at_++;
    batch.push(out_.origin[i], out_.end[i], out_.time_s[i], out_.intensity[i], out_.hit[i] != 0);
  }
  return batch.size();
}

Result<bool> MissingRaySource::rewind() {
  RAYFIELD_ASSIGN(const bool done, source_.rewind());
  if (!done) return false;
  in_.clear(), out_.clear();
  out_at_ = 0, restored_ = 0;
  studied_ = usable_ = ended_ = false;
  longest_m_ = period_s_ = 0;
  misses_ = {};
  last_ = {};
  return true;
}

std::vector<std::string> MissingRaySource::warnings() const {
  std::vector<std::string> out = source_.warnings();
  if (studied_ && !usable_ && !misses_.holds_downward())
    out.push_back(
        "the times of the rays do not tell beams apart: downward rays without a return cannot be restored, "
        "what runs level is left out of the density");
  else if (restored_ > 0)
    out.push_back(std::to_string(restored_) + " downward rays without a return restored from gaps between beams");
  return out;
}

}  // namespace rayfield::density
