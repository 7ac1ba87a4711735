#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "formats/picture/canvas.h"
#include "rayfield/core/result.h"

namespace rayfield::formats {

inline constexpr Rgba kGainColor{0, 122, 128, 255}, kLossColor{190, 92, 24, 255}, kSteadyColor{128, 134, 140, 255};

/// A range of values along one side of a chart.
struct ChartAxis {
  double low = 0, high = 1;       ///< values
  double from_px = 0, to_px = 1;  ///< their places
  std::vector<double> ticks;
  double px(double value) const { return from_px + (to_px - from_px) * (value - low) / (high - low); }
};

/// From 0 (or below, where there are values) to the tick above the highest value.
ChartAxis value_axis(double lowest, double highest, int most_ticks);

/// A frame of `size` at `corner` with light lines at the ticks and values along the left side and the foot.
struct ChartFrame {
  ChartAxis x, y;
  Eigen::Vector2d corner = Eigen::Vector2d::Zero(), size = Eigen::Vector2d::Zero();
  /// Sets both axes onto the frame.
  void place();
  Eigen::Vector2d px(double x_value, double y_value) const { return {x.px(x_value), y.px(y_value)}; }
};
struct ChartLabels {
  std::vector<std::string> x;  ///< one for each tick of x; empty: numbers
  bool at_left = true, at_foot = true;
  double text_px = 18;
};
void draw_chart_frame(Canvas& canvas, const ChartFrame& frame, const ChartLabels& labels, double unit_px);

/// Days since 1970-01-01. Errors: usage.
Result<double> day_of(const std::string& date);

/// Dates along the foot: firsts of months, years apart where the range is long, as "2018-11".
struct MonthTicks {
  std::vector<double> days;
  std::vector<std::string> labels;
};
MonthTicks month_ticks(double first_day, double last_day, int most);

}  // namespace rayfield::formats
