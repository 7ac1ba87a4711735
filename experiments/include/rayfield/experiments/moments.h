#pragma once

#include <cstdint>

/// Monte-Carlo experiments on the estimators of density: those of the paper (Lowe et al., Canopy Density Estimation in
/// Perennial Horticulture Crops Using 3D Spinning Lidar SLAM) and the bias of wide beams. docs/experiments.md.
namespace rayfield::experiments {

/// A mean over trials.
struct Mean {
  double value = 0;
  double standard_error = 0;  ///< 0 for fewer than two trials
};

/// Count, sum and sum of squares.
class Moments {
 public:
  void add(double x) { ++count_, sum_ += x, squares_ += x * x; }
  Moments& operator+=(const Moments& other);
  std::uint64_t count() const { return count_; }
  double variance() const;  ///< of one trial; 0 for fewer than two
  Mean mean() const;

 private:
  std::uint64_t count_ = 0;
  double sum_ = 0, squares_ = 0;
};

/// Normalised error ê = ⟨x − r⟩/⟨r⟩ of estimates x of true values r that differ from trial to trial (the paper's
/// "Simulation of Triangular Leaves in 3D Voxel").
class NormalisedError {
 public:
  void add(double estimate, double truth);
  NormalisedError& operator+=(const NormalisedError& other);
  /// Standard error to first order: that of the mean of (x − r) − ê·r, over ⟨r⟩.
  Mean mean() const;

 private:
  std::uint64_t count_ = 0;
  double error_ = 0, truth_ = 0;                                 // sums
  double error_squares_ = 0, truth_squares_ = 0, products_ = 0;  // of error and truth
};

}  // namespace rayfield::experiments
