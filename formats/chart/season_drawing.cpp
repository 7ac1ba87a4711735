#include "formats/chart/season_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "formats/chart/chart_axes.h"
#include "formats/picture/picture_elements.h"

namespace rayfield::formats {
namespace {

using Eigen::Vector2d;
using elements::kPictureWhat;

constexpr Rgba kBlockColor{96, 102, 108, 255};

/// One date of one curve.
struct Stop {
  double day = 0, value = 0, low = 0, high = 0;
  bool whole = true;  ///< all panels were seen
};
using Curve = std::vector<Stop>;

/// What is drawn: curves by row (0 is the block), thin ones of its panels, and their range.
struct Season {
  std::map<int, Curve> rows;
  std::map<int, std::vector<Curve>> panels;
  double first_day = std::numeric_limits<double>::infinity(), last_day = -first_day;
  double lowest = 0, highest = 0;
};

Result<void> take_values(std::span<const SeasonValue> values, Season& season) {
  for (const SeasonValue& v : values) {
    RAYFIELD_ASSIGN(const double day, day_of(v.scan_date));
    season.first_day = std::min(season.first_day, day), season.last_day = std::max(season.last_day, day);
    if (!std::isfinite(v.leaf_area_per_m)) continue;
    season.rows[v.row_number].push_back(
        {day, v.leaf_area_per_m, v.ci_low_per_m, v.ci_high_per_m, v.panels_seen == v.panels});
    season.lowest = std::min(season.lowest, v.ci_low_per_m), season.highest = std::max(season.highest, v.ci_high_per_m);
  }
  return {};
}

Result<void> take_panels(const BlockProducts& block, std::span<const int> rows, Season& season) {
  std::map<std::string, Curve> curves;
  for (const ScanResults& scan : block.scans) {
    RAYFIELD_ASSIGN(const double day, day_of(scan.scan.scan_date));
    for (const PanelValue& v : scan.panel_values)
      if (std::isfinite(v.leaf_area_per_m)) curves[v.panel_uid].push_back({day, v.leaf_area_per_m, 0, 0, true});
  }
  for (const PanelProduct& panel : block.panels) {
    if (std::find(rows.begin(), rows.end(), panel.row_number) == rows.end()) continue;
    for (const Stop& stop : curves[panel.panel_uid]) {
      season.lowest = std::min(season.lowest, stop.value), season.highest = std::max(season.highest, stop.value);
    }
    season.panels[panel.row_number].push_back(curves[panel.panel_uid]);
  }
  return {};
}

std::vector<Vector2d> line_of(const ChartFrame& frame, const Curve& curve) {
  std::vector<Vector2d> line;
  for (const Stop& stop : curve) line.push_back(frame.px(stop.day, stop.value));
  return line;
}

void draw_curve(Canvas& canvas, const ChartFrame& frame, const Curve& curve, const Rgba& color, double unit) {
  std::vector<Vector2d> band;
  for (const Stop& stop : curve) band.push_back(frame.px(stop.day, stop.high));
  for (auto stop = curve.rbegin(); stop != curve.rend(); ++stop) band.push_back(frame.px(stop->day, stop->low));
  Rgba light = color;
  light.a = 50;
  if (curve.size() > 1) canvas.polygon(band, light);
  canvas.polyline(line_of(frame, curve), {color, 2.6 * unit, 0});
  for (const Stop& stop : curve) {
    const Vector2d at = frame.px(stop.day, stop.value);
    canvas.polyline(std::array<Vector2d, 2>{frame.px(stop.day, stop.low), frame.px(stop.day, stop.high)},
                    {color, 1.6 * unit, 0});
    canvas.circle(at, 6 * unit, color);
    if (!stop.whole) canvas.circle(at, 3.6 * unit, {255, 255, 255, 255});
  }
}

/// The values above their points, if there are few enough dates to keep them apart; else only that of the last date.
void draw_numbers(Canvas& canvas, const ChartFrame& frame, const Curve& curve, double unit) {
  constexpr std::size_t kMost = 6;
  for (std::size_t i = curve.size() <= kMost ? 0 : curve.size() - 1; i < curve.size(); ++i) {
    const Vector2d at = frame.px(curve[i].day, curve[i].high);
    // Inside the frame, also at its ends.
    const double x = std::clamp(at.x(), frame.corner.x() + 24 * unit, frame.corner.x() + frame.size.x() - 24 * unit);
    canvas.text({x, at.y() - 9 * unit}, fmt::format("{:.2f}", curve[i].value),
                {15 * unit, elements::kInk, false, Align::middle, Align::end, 0, 3 * unit});
  }
}

/// Where the charts stand: columns of equal ones, the first of a line with the values' axis.
struct Sheet {
  int columns = 1, lines = 1;
  Vector2d corner = Vector2d::Zero(), size = Vector2d::Zero(), step = Vector2d::Zero();
  int height = 0;
};

Sheet arrange(const PictureOptions& options, std::size_t charts, double margin, double unit) {
  Sheet sheet;
  const int count = static_cast<int>(charts);
  sheet.columns = count <= 3 ? count : count <= 8 ? 3 : 4;
  sheet.columns = std::max(2, sheet.columns);
  sheet.lines = (count + sheet.columns - 1) / sheet.columns;
  sheet.corner = {margin + 96 * unit, elements::header_height(options, margin, unit) + 70 * unit};
  const double gap = 34 * unit, width = options.width_px - sheet.corner.x() - margin;
  sheet.size.x() = std::floor((width - gap * (sheet.columns - 1)) / sheet.columns);
  sheet.size.y() = std::round(std::min(0.68 * sheet.size.x(), 330 * unit));
  sheet.step = {sheet.size.x() + gap, sheet.size.y() + 64 * unit};
  sheet.height = static_cast<int>(std::ceil(sheet.corner.y() + sheet.lines * sheet.step.y() + 26 * unit));
  return sheet;
}

/// What the strokes mean, at the top right.
void draw_key(Canvas& canvas, const Sheet& sheet, const PictureOptions& options, double margin, double unit) {
  const TextStyle style{18 * unit, elements::kInk, false, Align::start, Align::middle};
  const double y = margin + 51 * unit;  // beside the subtitle: titles may be long
  double x = options.width_px - margin;
  const auto entry = [&](const std::string& text, const StrokeStyle& stroke, bool point) {
    x -= canvas.text_width_px(text, style);
    canvas.text({x, y}, text, style);
    x -= 48 * unit;
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(x, y), Vector2d(x + 36 * unit, y)}, stroke);
    if (point) canvas.circle({x + 18 * unit, y}, 6 * unit, stroke.color);
    x -= 30 * unit;
  };
  if (sheet.lines * sheet.columns > 1) entry("the whole block", {kBlockColor, 2 * unit, 7 * unit}, false);
  entry("its panels", {{0, 122, 128, 90}, 1.2 * unit, 0}, false);
  entry("row, 95 % interval", {kGainColor, 2.6 * unit, 0}, true);
}

}  // namespace

Result<void> draw_season(const BlockProducts& block, std::span<const SeasonValue> values, std::span<const int> rows,
                         const std::string& path, const PictureOptions& options) {
  Season season;
  RAYFIELD_CHECK(take_values(values, season));
  RAYFIELD_CHECK(take_panels(block, rows, season));
  if (values.empty() || season.rows.empty())
    return fail(ErrorCode::usage, kPictureWhat, path, "there are no values to draw");
  const double unit = options.width_px / 1600.0, margin = 36 * unit;
  const Sheet sheet = arrange(options, rows.size() + 1, margin, unit);
  RAYFIELD_ASSIGN(Canvas canvas, Canvas::create(options.width_px, sheet.height, {255, 255, 255, 255}, format_of(path)));
  elements::header(canvas, options, margin, unit);
  draw_key(canvas, sheet, options, margin, unit);
  const double border = std::max(6.0, 0.05 * (season.last_day - season.first_day));
  const MonthTicks months = month_ticks(season.first_day - border, season.last_day + border, sheet.columns > 3 ? 4 : 6);
  ChartFrame frame;
  frame.size = sheet.size;
  frame.y = value_axis(season.lowest, 1.05 * season.highest, 5);  // room for the numbers
  frame.x = {season.first_day - border, season.last_day + border, 0, 1, months.days};
  const int charts = static_cast<int>(rows.size()) + 1;
  for (int i = 0; i < charts; ++i) {
    const int row = i == 0 ? 0 : rows[static_cast<std::size_t>(i - 1)], column = i % sheet.columns;
    frame.corner = sheet.corner + sheet.step.cwiseProduct(Vector2d(column, i / sheet.columns));
    frame.corner = frame.corner.array().round();
    frame.place();
    draw_chart_frame(canvas, frame, {months.labels, column == 0, true, 15}, unit);
    const std::string name = row == 0 ? "whole block" : fmt::format("row {}", row);
    canvas.text(frame.corner - Vector2d(0, 10 * unit), name,
                {19 * unit, elements::kInk, true, Align::start, Align::end});
    canvas.clip(frame.corner, frame.size);
    for (const Curve& panel : season.panels[row])
      canvas.polyline(line_of(frame, panel), {{0, 122, 128, 90}, 1.2 * unit, 0});
    if (row != 0) canvas.polyline(line_of(frame, season.rows[0]), {kBlockColor, 2 * unit, 7 * unit});
    draw_curve(canvas, frame, season.rows[row], row == 0 ? kBlockColor : kGainColor, unit);
    draw_numbers(canvas, frame, season.rows[row], unit);
    canvas.unclip();
  }
  canvas.text({margin + 20 * unit, sheet.corner.y() + (sheet.lines * sheet.step.y() - 64 * unit) / 2},
              "Leaf area per metre of row, m²/m",
              {19 * unit, elements::kInk, false, Align::middle, Align::end, M_PI / 2, 0});
  return canvas.write(path);
}

}  // namespace rayfield::formats
