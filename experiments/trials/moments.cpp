#include "rayfield/experiments/moments.h"

#include <algorithm>
#include <cmath>

namespace rayfield::experiments {

Moments& Moments::operator+=(const Moments& other) {
  count_ += other.count_, sum_ += other.sum_, squares_ += other.squares_;
  return *this;
}

double Moments::variance() const {
  if (count_ < 2) return 0;
  const auto n = static_cast<double>(count_);
  return std::max(0.0, (squares_ - sum_ * sum_ / n) / (n - 1));
}

Mean Moments::mean() const {
  if (count_ == 0) return {};
  const auto n = static_cast<double>(count_);
  return {sum_ / n, std::sqrt(variance() / n)};
}

void NormalisedError::add(double estimate, double truth) {
  const double error = estimate - truth;
  ++count_;
  error_ += error, truth_ += truth;
  error_squares_ += error * error, truth_squares_ += truth * truth, products_ += error * truth;
}

NormalisedError& NormalisedError::operator+=(const NormalisedError& other) {
  count_ += other.count_;
  error_ += other.error_, truth_ += other.truth_;
  error_squares_ += other.error_squares_, truth_squares_ += other.truth_squares_, products_ += other.products_;
  return *this;
}

// The residuals (x − r) − ê·r have mean 0 by the choice of ê.
Mean NormalisedError::mean() const {
  if (count_ == 0 || truth_ == 0) return {};
  const double ratio = error_ / truth_;
  if (count_ < 2) return {ratio, 0};
  const auto n = static_cast<double>(count_);
  const double squares = error_squares_ - 2 * ratio * products_ + ratio * ratio * truth_squares_;
  return {ratio, std::sqrt(std::max(0.0, squares) * n / (n - 1)) / std::abs(truth_)};
}

}  // namespace rayfield::experiments
