#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "libalign/evidence/cover.h"
#include "libalign/evidence/upright_index.h"
#include "rayfield/align/options.h"
#include "rayfield/align/plan_shift.h"
#include "rayfield/core/landmarks.h"

namespace rayfield::align {

/// The landmarks of a scan and of its block's reference, ready to be looked up. Both must outlive it.
struct LandmarkPair {
  const BlockLandmarks& reference;
  const BlockLandmarks& scan;
  UprightIndex index;                               ///< of the reference's uprights
  Cover reference_cover, scan_cover;                ///< where each looked closely
  Cover reference_rows, scan_rows;                  ///< where each has rows
  Eigen::Vector2d pivot = Eigen::Vector2d::Zero();  ///< middle of the scan's uprights
  double uprights_per_m2 = 1;                       ///< of the scan, in the strips in which they are found

  LandmarkPair(const BlockLandmarks& reference_landmarks, const BlockLandmarks& scan_landmarks, double reach_m);
};

/// An upright of the scan and the reference's that it is taken for.
struct Match {
  int scan = 0, reference = 0;
  double distance_m = 0;  ///< in plan, after the shift
};

inline constexpr double kMatchRadius_m = 0.25;  ///< what stands further apart is not the same post

/// Pairs of uprights that are each other's nearest within `radius_m` (at most 1 m) after the shift, in the scan's
/// order.
std::vector<Match> match_uprights(const LandmarkPair& pair, const PlanShift& shift, double radius_m);

/// Mean square of distances, those beyond three times their median left out; NaN without any.
double trimmed_mean_square(std::span<const double> distances);

/// How the shapes of the ground agree after a shift in plan.
struct GroundAgreement {
  double offset_m = 0;     ///< median of reference minus scan; 0 without common cells
  double deviation_m = 0;  ///< median of the deviations from it; NaN without common cells
  double area_m2 = 0;      ///< of the common cells
};
GroundAgreement compare_ground(const LandmarkPair& pair, const PlanShift& shift);

/// What speaks for a shift.
struct Evidence {
  int matched = 0;
  int shared = 0;         ///< uprights of either scan that stand where both looked
  double residual_m = 0;  ///< median distance of the matches, m
  GroundAgreement ground;
  int beyond = 0;  ///< of those, without a partner and where the other scan looked and has no row
  double log_uprights = 0, log_ground = 0, log_prior = 0;  ///< logarithms of likelihoods, up to a common constant
  double log_likelihood() const { return log_uprights + log_ground + log_prior; }
  double shared_fraction() const { return shared > 0 ? 2.0 * matched / shared : 0; }
};
Evidence weigh(const LandmarkPair& pair, const PlanShift& shift, const SearchOptions& options);

}  // namespace rayfield::align
