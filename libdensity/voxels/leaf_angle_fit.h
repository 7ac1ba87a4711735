#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "libdensity/voxels/direction_counters.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// How likely the directions of the hits in some voxels are, given how many hits each voxel has, by how leaves are
/// turned (ln of the ratio of the axes of Campbell's ellipsoid) and by how apparent density falls with the diameter of
/// beams (exp(−loss·diameter)). Relative to one another.
class DirectionLikelihood {
 public:
  static constexpr int kRatios = 14, kLosses = 11;
  static constexpr double kLnRatioStep = 0.2, kFirstLnRatio = -0.6;  ///< spherical leaves: 0
  static constexpr double kLossStepPerM = 6;

  /// `full_echo`: intensity of a whole hit; 1 for thin beams, whose hits are counted.
  void add(const DirectionCounters& voxel, double full_echo);
  DirectionLikelihood& operator+=(const DirectionLikelihood& other);
  DirectionLikelihood& operator-=(const DirectionLikelihood& other);

  double hits() const { return hits_; }
  /// The most likely ln of the ratio; nothing where it lies at an end of what is looked at. `wide`: with the loss that
  /// is most likely for it, else without loss.
  std::optional<double> ln_ratio(bool wide) const;

 private:
  double at(int ratio, bool wide) const;
  double hits_ = 0;
  std::array<std::array<double, kLosses>, kRatios> ln_{};
};

/// What the hits of a scan say of its leaves' angles.
struct LeafAngleFit {
  double ln_ratio = 0, error = 0;  ///< of Campbell's ellipsoid, and its standard error
  bool measured = false;           ///< there are enough hits, and they agree
  /// Leaves are taken for spherical unless they are clearly flatter.
  LeafAngles angles() const;
};

/// From parts of a scan that are independent of each other; errors from how they differ (jackknife).
LeafAngleFit fit_leaf_angles(std::span<const DirectionLikelihood> parts, bool wide);

}  // namespace rayfield::density
