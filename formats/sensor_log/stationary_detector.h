#pragma once

#include <cmath>
#include <numbers>

namespace rayfield::formats {

/// The longest time that an angle stood still: a spinner, or its encoder, that got stuck.
class StationaryDetector {
 public:
  void add(double time_s, double angle_rad) {
    constexpr double kMoved_rad = 0.01;  // more than an encoder's noise, passed within milliseconds by a spinner
    if (!started_ || time_s < since_s_ ||
        std::abs(std::remainder(angle_rad - angle_rad_, 2 * std::numbers::pi)) > kMoved_rad) {
      started_ = true;
      since_s_ = time_s;
      angle_rad_ = angle_rad;
    }
    if (time_s - since_s_ > longest_s_) {
      longest_s_ = time_s - since_s_;
      longest_since_s_ = since_s_;
    }
  }
  double longest_s() const { return longest_s_; }
  double longest_since_s() const { return longest_since_s_; }

 private:
  bool started_ = false;
  double since_s_ = 0, angle_rad_ = 0, longest_s_ = 0, longest_since_s_ = 0;
};

}  // namespace rayfield::formats
