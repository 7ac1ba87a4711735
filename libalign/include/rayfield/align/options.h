#pragma once

#include "rayfield/core/option_fields.h"
#include "rayfield/core/result.h"

/// options: what can be set. Members give defaults, visit_fields() gives ranges and meanings (docs/options.md).
namespace rayfield::align {

/// Which shifts are looked for, and how likely each is before any landmark is seen.
struct SearchOptions {
  double max_shift_m = 15;
  double max_yaw_rad = 0.17;
  double gps_sigma_m = 3.5;
  double yaw_sigma_rad = 0.03;
  double reach_m = 2.6;
  int candidates = 40;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("max_shift_m", o.max_shift_m, {0.5, 200}, "Largest shift of the block's middle");
    v.number("max_yaw_rad", o.max_yaw_rad, {0.005, 0.7}, "Largest turn, from 0 and from half a turn");
    v.number("gps_sigma_m", o.gps_sigma_m, {0.01, 100},
             "Standard deviation of the offset between two dates, per axis: that of two positions by cheap GPS");
    v.number("yaw_sigma_rad", o.yaw_sigma_rad, {1e-4, 1}, "Standard deviation of the turn between two dates");
    v.number("reach_m", o.reach_m, {1, 10},
             "A post or trunk this near to the vehicle's track should be seen; half the widest lane");
    v.integer("candidates", o.candidates, {2, 1000}, "Hypotheses that are fitted and weighed");
  }
};

/// When an alignment is believed.
struct AcceptOptions {
  int min_landmarks = 6;
  double min_shared = 0.35;
  double max_residual_m = 0.10;
  double max_ground_m = 0.15;
  double min_margin = 12;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.integer("min_landmarks", o.min_landmarks, {3, 1000}, "Posts and trunks that both scans must show");
    v.number("min_shared", o.min_shared, {0.05, 1},
             "Share of the posts and trunks seen where both scans looked that both must show");
    v.number("max_residual_m", o.max_residual_m, {0.005, 1}, "Largest residual between them in plan, median");
    v.number("max_ground_m", o.max_ground_m, {0.01, 2},
             "Largest difference between the shapes of the ground, median; grass and tillage lie below it");
    v.number("min_margin", o.min_margin, {0, 1000},
             "By how much the best hypothesis must be more likely than any other, as a natural logarithm, beside three "
             "times the root of the matched landmarks, which chance makes");
  }
};

/// The smooth warp that takes up the drift of SLAM.
struct WarpOptions {
  bool enabled = true;
  double spacing_m = 12;
  double bend_sigma_m = 0.01;
  double min_gain = 0.1;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.flag("enabled", o.enabled, "Bend the scan where that fits landmarks better that had no part in the fit");
    v.number("spacing_m", o.spacing_m, {3, 100}, "Between the control points of the cubic B-spline");
    v.number("bend_sigma_m", o.bend_sigma_m, {1e-4, 1},
             "Standard deviation of second differences of neighbouring control points; smaller = stiffer");
    v.number("min_gain", o.min_gain, {0, 1}, "Share by which left-out landmarks must fit better than without a warp");
  }
};

struct AlignOptions {
  SearchOptions search;
  AcceptOptions accept;
  WarpOptions warp;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.group("search", o.search);
    v.group("accept", o.accept);
    v.group("warp", o.warp);
  }
  Result<void> validate() const;
};

}  // namespace rayfield::align
