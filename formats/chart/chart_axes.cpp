#include "formats/chart/chart_axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "formats/picture/color.h"
#include "formats/picture/picture_elements.h"
#include "rayfield/core/date.h"

namespace rayfield::formats {

using Eigen::Vector2d;

ChartAxis value_axis(double lowest, double highest, int most_ticks) {
  ChartAxis axis;
  axis.low = std::min(0.0, lowest), axis.high = std::max(highest, axis.low + 1e-3);
  const std::vector<double> ticks = nice_ticks(axis.low, axis.high, most_ticks);
  if (ticks.size() > 1) {
    const double step = ticks[1] - ticks[0];
    axis.low = step * std::floor(axis.low / step + 1e-9), axis.high = step * std::ceil(axis.high / step - 1e-9);
  }
  axis.ticks = nice_ticks(axis.low, axis.high, most_ticks + 2);
  return axis;
}

void ChartFrame::place() {
  x.from_px = corner.x(), x.to_px = corner.x() + size.x();
  y.from_px = corner.y() + size.y(), y.to_px = corner.y();
}

void draw_chart_frame(Canvas& canvas, const ChartFrame& frame, const ChartLabels& labels, double unit_px) {
  const StrokeStyle line{{228, 231, 234, 255}, 1 * unit_px, 0}, mark{elements::kFrameGrey, 1.2 * unit_px, 0};
  const double left = frame.corner.x(), foot = frame.corner.y() + frame.size.y(), length = 6 * unit_px;
  canvas.rectangle(frame.corner, frame.size, {252, 252, 250, 255});
  const auto step_of = [](const ChartAxis& axis) {
    return axis.ticks.size() > 1 ? axis.ticks[1] - axis.ticks[0] : 1.0;
  };
  for (const double tick : frame.y.ticks) {
    const double y = frame.y.px(tick);
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(left, y), Vector2d(left + frame.size.x(), y)}, line);
    if (!labels.at_left) continue;
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(left - length, y), Vector2d(left, y)}, mark);
    canvas.text({left - 2 * length, y}, tick_text(tick, step_of(frame.y)),
                {labels.text_px * unit_px, elements::kInk, false, Align::end, Align::middle});
  }
  for (std::size_t i = 0; i < frame.x.ticks.size(); ++i) {
    const double tick = frame.x.ticks[i], x = frame.x.px(tick);
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(x, frame.corner.y()), Vector2d(x, foot)}, line);
    if (!labels.at_foot) continue;
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(x, foot), Vector2d(x, foot + length)}, mark);
    canvas.text({x, foot + 2 * length}, i < labels.x.size() ? labels.x[i] : tick_text(tick, step_of(frame.x)),
                {labels.text_px * unit_px, elements::kInk, false, Align::middle, Align::start});
  }
  elements::frame(canvas, frame.corner, frame.size, unit_px);
}

Result<double> day_of(const std::string& date) {
  RAYFIELD_ASSIGN(const std::chrono::year_month_day day, parse_calendar_day(date));
  return static_cast<double>(std::chrono::sys_days(day).time_since_epoch().count());
}

MonthTicks month_ticks(double first_day, double last_day, int most) {
  const auto date = [](double day) {
    return std::chrono::year_month_day(std::chrono::sys_days(std::chrono::days(static_cast<int>(std::floor(day)))));
  };
  const std::chrono::year_month_day first = date(first_day), last = date(last_day);
  const auto number = [](const std::chrono::year_month_day& d) {
    return 12 * static_cast<int>(d.year()) + static_cast<int>(static_cast<unsigned>(d.month())) - 1;
  };
  const int from = number(first), to = number(last);
  int step = 1;
  for (const int candidate : {1, 2, 3, 6, 12, 24, 60, 120, 1200}) {
    step = candidate;
    if ((to - from) / step + 1 <= most) break;
  }
  MonthTicks ticks;
  for (int month = (from + step - 1) / step * step; month <= to + 1; month += step) {
    const std::chrono::year_month_day day{
        std::chrono::year(month / 12), std::chrono::month(static_cast<unsigned>(month % 12 + 1)), std::chrono::day(1)};
    const auto at = static_cast<double>(std::chrono::sys_days(day).time_since_epoch().count());
    if (at < first_day || at > last_day) continue;
    ticks.days.push_back(at);
    ticks.labels.push_back(fmt::format("{:04d}-{:02d}", month / 12, month % 12 + 1));
  }
  return ticks;
}

}  // namespace rayfield::formats
