#include "formats/chart/series_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "formats/chart/chart_axes.h"
#include "formats/picture/picture_elements.h"

namespace rayfield::formats {
namespace {

using Eigen::Vector2d;
using elements::kPictureWhat;

/// Of the series in the order of their names' first use; those of changes first, then others that stay apart from them
/// in lightness too. More series begin again.
constexpr std::array<Rgba, 7> kSeriesColors{{kGainColor,
                                             kLossColor,
                                             {58, 84, 160, 255},
                                             {150, 60, 120, 255},
                                             {112, 128, 30, 255},
                                             {70, 74, 80, 255},
                                             {214, 158, 40, 255}}};

/// A name in the key.
struct KeyEntry {
  std::string name;
  SeriesMark mark;
};

std::vector<KeyEntry> key_of(const SeriesChart& chart) {
  std::vector<KeyEntry> key;
  for (const ChartPanel& panel : chart.panels)
    for (const ChartSeries& series : panel.series)
      if (std::none_of(key.begin(), key.end(), [&](const KeyEntry& e) { return e.name == series.name; }))
        key.push_back({series.name, series.mark});
  return key;
}

Rgba color_of(const std::vector<KeyEntry>& key, const std::string& name) {
  const auto at = std::find_if(key.begin(), key.end(), [&](const KeyEntry& e) { return e.name == name; });
  return kSeriesColors[static_cast<std::size_t>(at - key.begin()) % kSeriesColors.size()];
}

double position(const SeriesChart& chart, double x) { return chart.logarithmic_x ? std::log10(x) : x; }

bool drawn(const ChartPoint& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.standard_error);
}

Result<void> check(const SeriesChart& chart, const std::string& path) {
  const auto refuse = [&](std::string_view why) { return fail(ErrorCode::usage, kPictureWhat, path, why); };
  const std::vector<double>& ticks = chart.x_ticks;
  if (chart.panels.empty()) return refuse("there is no panel to draw");
  if (ticks.size() < 2 || std::adjacent_find(ticks.begin(), ticks.end(), std::greater_equal<>()) != ticks.end())
    return refuse("the ticks are not two or more ascending values");
  if (chart.logarithmic_x && !(ticks.front() > 0)) return refuse("a logarithmic axis has a tick at or below 0");
  if (!chart.x_labels.empty() && chart.x_labels.size() != ticks.size())
    return refuse("there are not as many labels as ticks");
  for (const ChartPanel& panel : chart.panels)
    for (const ChartSeries& series : panel.series)
      if (std::any_of(series.points.begin(), series.points.end(), drawn)) return {};
  return refuse("there are no values to draw");
}

/// Both axes, for all panels.
ChartFrame axes_of(const SeriesChart& chart) {
  double lowest = 0, highest = 0;
  for (const ChartPanel& panel : chart.panels)
    for (const ChartSeries& series : panel.series)
      for (const ChartPoint& p : series.points) {
        if (!drawn(p)) continue;
        lowest = std::min(lowest, p.y - p.standard_error), highest = std::max(highest, p.y + p.standard_error);
      }
  ChartFrame frame;
  frame.y = value_axis(lowest, highest, 7);
  for (const double tick : chart.x_ticks) frame.x.ticks.push_back(position(chart, tick));
  const double border = 0.05 * (frame.x.ticks.back() - frame.x.ticks.front());
  frame.x.low = frame.x.ticks.front() - border, frame.x.high = frame.x.ticks.back() + border;
  return frame;
}

/// Labels of a logarithmic axis are the values, not their logarithms.
std::vector<std::string> labels_of(const SeriesChart& chart) {
  std::vector<std::string> labels = chart.x_labels;
  if (!labels.empty() || !chart.logarithmic_x) return labels;
  for (const double tick : chart.x_ticks) labels.push_back(tick_text(tick, tick));
  return labels;
}

void draw_one(Canvas& canvas, const SeriesChart& chart, const ChartFrame& frame, const ChartSeries& series,
              const Rgba& color, double unit) {
  std::vector<Vector2d> line;
  for (const ChartPoint& p : series.points)
    if (drawn(p)) line.push_back(frame.px(position(chart, p.x), p.y));
  if (series.mark != SeriesMark::discs && line.size() > 1)
    canvas.polyline(line, series.mark == SeriesMark::line ? StrokeStyle{color, 2.2 * unit, 9 * unit}
                                                          : StrokeStyle{color, 1.6 * unit, 0});
  if (series.mark == SeriesMark::line) return;
  for (const ChartPoint& p : series.points) {
    if (!drawn(p)) continue;
    const double x = position(chart, p.x);
    canvas.polyline(std::array<Vector2d, 2>{frame.px(x, p.y - p.standard_error), frame.px(x, p.y + p.standard_error)},
                    {color, 1.8 * unit, 0});
    canvas.circle(frame.px(x, p.y), 6.5 * unit, {255, 255, 255, 230});
    canvas.circle(frame.px(x, p.y), 5 * unit, color);
  }
}

/// The key, from the left and in as many lines as it needs. Returns the y below it; with `draw` false only that.
double draw_key(Canvas& canvas, const std::vector<KeyEntry>& key, const Vector2d& corner, double width, double unit,
                bool draw) {
  const TextStyle style{18 * unit, elements::kInk, false, Align::start, Align::middle};
  Vector2d at = corner;
  for (const KeyEntry& entry : key) {
    const double entry_width = 46 * unit + canvas.text_width_px(entry.name, style) + 34 * unit;
    if (at.x() > corner.x() && at.x() + entry_width > corner.x() + width) at = {corner.x(), at.y() + 30 * unit};
    if (draw) {
      const Rgba color = color_of(key, entry.name);
      const StrokeStyle stroke{color, 2.2 * unit, entry.mark == SeriesMark::line ? 9 * unit : 0};
      if (entry.mark != SeriesMark::discs)
        canvas.polyline(std::array<Vector2d, 2>{at, Vector2d(at + Vector2d(36 * unit, 0))}, stroke);
      if (entry.mark != SeriesMark::line) canvas.circle(at + Vector2d(18 * unit, 0), 5.5 * unit, color);
      canvas.text(at + Vector2d(46 * unit, 0), entry.name, style);
    }
    at.x() += entry_width;
  }
  return at.y() + 22 * unit;
}

/// Where the panels stand.
struct Sheet {
  int columns = 1, lines = 1;
  Vector2d corner = Vector2d::Zero(), size = Vector2d::Zero(), step = Vector2d::Zero();
  int height = 0;
};

Sheet arrange(std::size_t panels, const Vector2d& corner, double width, double unit) {
  Sheet sheet;
  const int count = static_cast<int>(panels);
  sheet.columns = count <= 3 ? count : count == 4 ? 2 : 3;
  sheet.lines = (count + sheet.columns - 1) / sheet.columns;
  sheet.corner = corner;
  const double gap = 30 * unit;
  sheet.size.x() = std::floor((width - gap * (sheet.columns - 1)) / sheet.columns);
  sheet.size.y() = std::round(sheet.columns == 1 ? 0.5 * sheet.size.x() : 0.8 * sheet.size.x());
  sheet.step = {sheet.size.x() + gap, sheet.size.y() + 86 * unit};
  sheet.height = static_cast<int>(std::ceil(corner.y() + sheet.lines * sheet.step.y() + 34 * unit));
  return sheet;
}

void draw_panels(Canvas& canvas, const SeriesChart& chart, const Sheet& sheet, const std::vector<KeyEntry>& key,
                 double unit) {
  ChartFrame frame = axes_of(chart);
  frame.size = sheet.size;
  const std::vector<std::string> labels = labels_of(chart);
  for (std::size_t i = 0; i < chart.panels.size(); ++i) {
    const ChartPanel& panel = chart.panels[i];
    const int column = static_cast<int>(i) % sheet.columns, line = static_cast<int>(i) / sheet.columns;
    frame.corner = (sheet.corner + sheet.step.cwiseProduct(Vector2d(column, line))).array().round();
    frame.place();
    draw_chart_frame(canvas, frame, {labels, column == 0, true, 16}, unit);
    canvas.polyline(std::array<Vector2d, 2>{frame.px(frame.x.low, 0), frame.px(frame.x.high, 0)},
                    {elements::kGrey, 1.8 * unit, 0});
    canvas.text(frame.corner - Vector2d(0, 10 * unit), panel.title,
                {19 * unit, elements::kInk, true, Align::start, Align::end});
    canvas.clip(frame.corner, frame.size);
    for (const ChartSeries& series : panel.series)
      draw_one(canvas, chart, frame, series, color_of(key, series.name), unit);
    canvas.unclip();
  }
}

}  // namespace

Result<void> draw_series(const SeriesChart& chart, const std::string& path, const PictureOptions& options) {
  RAYFIELD_CHECK(check(chart, path));
  const double unit = options.width_px / 1600.0, margin = 36 * unit, left = margin + 104 * unit;
  const double width = options.width_px - left - margin;
  const std::vector<KeyEntry> key = key_of(chart);
  const Vector2d key_corner(left, elements::header_height(options, margin, unit) + 26 * unit);
  // The height of the picture follows from the lines of the key, which need a canvas to be measured on.
  RAYFIELD_ASSIGN(Canvas measure, Canvas::create(1, 1));
  const double top = draw_key(measure, key, key_corner, width, unit, false) + 36 * unit;
  const Sheet sheet = arrange(chart.panels.size(), {left, top}, width, unit);
  RAYFIELD_ASSIGN(Canvas canvas, Canvas::create(options.width_px, sheet.height, {255, 255, 255, 255}, format_of(path)));
  elements::header(canvas, options, margin, unit);
  draw_key(canvas, key, key_corner, width, unit, true);
  draw_panels(canvas, chart, sheet, key, unit);
  const double foot = sheet.corner.y() + sheet.lines * sheet.step.y() - 28 * unit;
  canvas.text({left + 0.5 * width, foot}, chart.x_title,
              {19 * unit, elements::kInk, false, Align::middle, Align::start});
  canvas.text({margin + 20 * unit, sheet.corner.y() + (sheet.lines * sheet.step.y() - 86 * unit) / 2}, chart.y_title,
              {19 * unit, elements::kInk, false, Align::middle, Align::end, std::numbers::pi / 2, 0});
  return canvas.write(path);
}

}  // namespace rayfield::formats
