#include "formats/chart/scatter_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "formats/chart/chart_axes.h"
#include "formats/picture/color.h"
#include "formats/picture/picture_elements.h"

namespace rayfield::formats {
namespace {

using Eigen::Vector2d;
using elements::kPictureWhat;

constexpr Rgba kTrendColor{58, 84, 160, 255};

/// A panel in the chart's values, m²/m, with the ends of its intervals.
struct Point {
  Vector2d value, low, high;
  ChangeVerdict verdict;
};

std::vector<Point> points_of(const DateComparison& comparison) {
  std::vector<Point> points;
  for (const PanelChange& panel : comparison.panels) {
    if (panel.verdict == ChangeVerdict::not_seen || !(panel.length_m > 0)) continue;
    const Vector2d value(panel.a.leaf_area_m2, panel.b.leaf_area_m2);
    const Vector2d low(panel.a.ci_low_m2, panel.b.ci_low_m2), high(panel.a.ci_high_m2, panel.b.ci_high_m2);
    points.push_back({value / panel.length_m, low / panel.length_m, high / panel.length_m, panel.verdict});
  }
  return points;
}

Rgba color_of(ChangeVerdict verdict) {
  return verdict == ChangeVerdict::gain ? kGainColor : verdict == ChangeVerdict::loss ? kLossColor : kSteadyColor;
}

/// Up for a gain, down for a loss, a disc for neither, on a white rim.
void draw_symbol(Canvas& canvas, const Vector2d& at, ChangeVerdict verdict, double radius_px) {
  const Rgba color = color_of(verdict), rim{255, 255, 255, 230};
  if (verdict != ChangeVerdict::gain && verdict != ChangeVerdict::loss) {
    canvas.circle(at, 1.1 * radius_px, rim);
    canvas.circle(at, 0.85 * radius_px, color);
    return;
  }
  const double up = verdict == ChangeVerdict::gain ? -1 : 1;
  for (const double r : {1.5 * radius_px, 1.15 * radius_px}) {
    const std::array<Vector2d, 3> corners = {at + Vector2d(0, up * r), at + Vector2d(-0.87 * r, -0.5 * up * r),
                                             at + Vector2d(0.87 * r, -0.5 * up * r)};
    canvas.polygon(corners, r > 1.3 * radius_px ? rim : color);
  }
}

ChartFrame frame_of(const std::vector<Point>& points, const Vector2d& corner, double side) {
  double lowest = 0, highest = 0;
  for (const Point& p : points) {
    lowest = std::min({lowest, p.value.minCoeff(), p.low.minCoeff()});
    highest = std::max({highest, p.value.maxCoeff(), p.high.maxCoeff()});
  }
  ChartFrame frame;
  frame.x = frame.y = value_axis(lowest, highest, 7);
  frame.corner = corner, frame.size = {side, side};
  frame.place();
  return frame;
}

void draw_points(Canvas& canvas, const ChartFrame& frame, const std::vector<Point>& points, double unit) {
  const bool crowded = points.size() > 150;
  for (const Point& p : points) {
    Rgba color = color_of(p.verdict);
    color.a = crowded ? 60 : 110;
    const StrokeStyle bar{color, 1.6 * unit, 0};
    canvas.polyline(std::array<Vector2d, 2>{frame.px(p.low.x(), p.value.y()), frame.px(p.high.x(), p.value.y())}, bar);
    canvas.polyline(std::array<Vector2d, 2>{frame.px(p.value.x(), p.low.y()), frame.px(p.value.x(), p.high.y())}, bar);
  }
  for (const Point& p : points)
    draw_symbol(canvas, frame.px(p.value.x(), p.value.y()), p.verdict, (crowded ? 5.5 : 8) * unit);
}

/// The line of no change over the whole chart, the trend over the panels' range.
void draw_lines(Canvas& canvas, const ChartFrame& frame, const std::vector<Point>& points, const PairedStatistics& s,
                double unit) {
  const double low = frame.x.low, high = frame.x.high;
  canvas.polyline(std::array<Vector2d, 2>{frame.px(low, low), frame.px(high, high)}, {elements::kGrey, 1.8 * unit, 0});
  if (!std::isfinite(s.slope)) return;
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (const Point& p : points) first = std::min(first, p.value.x()), last = std::max(last, p.value.x());
  const auto trend = [&](double x) { return frame.px(x, s.intercept + s.slope * x); };
  canvas.polyline(std::array<Vector2d, 2>{trend(first), trend(last)}, {kTrendColor, 2.6 * unit, 10 * unit});
}

std::string signed_text(double value, int digits) {
  const std::string text = fmt::format("{:.{}f}", std::abs(value), digits);
  const bool zero = text.find_first_not_of("0.") == std::string::npos;
  return zero ? text : (value < 0 ? "−" : "+") + text;
}

/// "1.07 · x + 0.31"
std::string line_text(double slope, double intercept) {
  return fmt::format("{:.2f} · x {} {:.2f}", slope, intercept < 0 ? "−" : "+", std::abs(intercept));
}

/// The column of words on the right.
class Column {
 public:
  Column(Canvas& canvas, const Vector2d& corner, double width, double unit)
      : canvas_(canvas), at_(corner), width_(width), unit_(unit) {}

  void heading(std::string_view text) {
    at_.y() += 14 * unit_;
    canvas_.text(at_, text, {20 * unit_, elements::kInk, true, Align::start, Align::start});
    at_.y() += 34 * unit_;
  }
  void line(std::string_view text, const Rgba& color = elements::kInk, double indent_px = 0) {
    const TextStyle style{19 * unit_, color, false, Align::start, Align::start};
    for (const std::string& part : elements::wrap(canvas_, text, style, width_ - indent_px)) {
      canvas_.text(at_ + Vector2d(indent_px, 0), part, style);
      at_.y() += 28 * unit_;
    }
  }
  void symbol(ChangeVerdict verdict, std::string_view text) {
    draw_symbol(canvas_, at_ + Vector2d(14 * unit_, 7 * unit_), verdict, 8 * unit_);
    line(text, elements::kInk, 42 * unit_);
  }
  void stroke(const StrokeStyle& style, std::string_view text) {
    const Vector2d middle = at_ + Vector2d(0, 7 * unit_);
    canvas_.polyline(std::array<Vector2d, 2>{middle, Vector2d(middle + Vector2d(30 * unit_, 0))}, style);
    line(text, elements::kInk, 42 * unit_);
  }
  void gap() { at_.y() += 12 * unit_; }

 private:
  Canvas& canvas_;
  Vector2d at_;
  double width_, unit_;
};

// The text beside the chart: counts of panels, total change, statistics and the key.
void draw_column(Column column, const DateComparison& c, double unit) {
  column.heading("Panels");
  column.symbol(ChangeVerdict::gain, fmt::format("gain: {}", c.gains));
  column.symbol(ChangeVerdict::loss, fmt::format("loss: {}", c.losses));
  column.symbol(ChangeVerdict::none, fmt::format("within the errors: {}", c.compared - c.gains - c.losses));
  if (c.not_seen > 0) column.line(fmt::format("not seen on both dates: {}", c.not_seen), elements::kGrey, 42 * unit);
  column.gap();
  column.heading("Leaf area of these panels");
  const TotalChange& t = c.leaf_total;
  column.line(fmt::format("{:.1f} m² → {:.1f} m²", t.area_a_m2, t.area_b_m2));
  column.line(t.area_a_m2 > 0 ? fmt::format("{} m² ({} %)", signed_text(t.change_m2, 1),
                                            signed_text(100 * t.change_m2 / t.area_a_m2, 0))
                              : signed_text(t.change_m2, 1) + " m²");
  column.line(fmt::format("95 %: {} … {} m²", signed_text(t.ci_low_m2, 1), signed_text(t.ci_high_m2, 1)),
              elements::kGrey);
  column.gap();
  column.heading("One date against the other");
  const PairedStatistics& s = c.leaf_per_m;
  column.line(std::isfinite(s.rrmse) ? fmt::format("RRMSE {:.1f} %", 100 * s.rrmse)
                                     : fmt::format("RMSE {:.2f} m²/m", s.rmse));
  if (std::isfinite(s.r_squared)) column.line(fmt::format("r² {:.3f}", s.r_squared));
  column.gap();
  column.stroke({elements::kGrey, 1.8 * unit, 0}, "no change");
  if (std::isfinite(s.slope)) {
    column.stroke({kTrendColor, 2.6 * unit, 10 * unit}, "least-squares trend");
    column.line(line_text(s.slope, s.intercept), kTrendColor, 42 * unit);
  }
  column.gap();
  column.line("Bars: 95 % intervals. Of panels that did not change, one in twenty reads as gain or loss.",
              elements::kGrey);
}

}  // namespace

Result<void> draw_scatter(const DateComparison& comparison, const std::string& path, const PictureOptions& options) {
  const std::vector<Point> points = points_of(comparison);
  if (points.empty()) return fail(ErrorCode::usage, kPictureWhat, path, "no panel was seen on both dates");
  const double unit = options.width_px / 1600.0, margin = 36 * unit;
  const double top = elements::header_height(options, margin, unit) + 8 * unit, left = margin + 92 * unit;
  const double side = std::round(1000 * unit), column = left + side + 46 * unit;
  const int height = static_cast<int>(std::ceil(top + side + 84 * unit + margin));
  RAYFIELD_ASSIGN(Canvas canvas, Canvas::create(options.width_px, height, {255, 255, 255, 255}, format_of(path)));
  elements::header(canvas, options, margin, unit);
  const ChartFrame frame = frame_of(points, {std::round(left), std::round(top)}, side);
  draw_chart_frame(canvas, frame, {}, unit);
  canvas.clip(frame.corner, frame.size);
  draw_lines(canvas, frame, points, comparison.leaf_per_m, unit);
  draw_points(canvas, frame, points, unit);
  canvas.unclip();
  TextStyle title{20 * unit, elements::kInk, false, Align::middle, Align::start};
  canvas.text({frame.corner.x() + side / 2, frame.corner.y() + side + 52 * unit},
              fmt::format("Leaf area per metre of row on {}, m²/m", comparison.a.scan_date), title);
  title.rotation_rad = M_PI / 2, title.vertical = Align::end;
  canvas.text({margin + 22 * unit, frame.corner.y() + side / 2},
              fmt::format("Leaf area per metre of row on {}, m²/m", comparison.b.scan_date), title);
  draw_column(Column(canvas, {column, top - 8 * unit}, options.width_px - column - margin, unit), comparison, unit);
  return canvas.write(path);
}

}  // namespace rayfield::formats
