#include "formats/picture/end_on_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "formats/picture/color.h"
#include "formats/picture/picture_elements.h"
#include "formats/picture/render_grid.h"
#include "formats/picture/section_drawing.h"

namespace rayfield::formats {
namespace {

using Eigen::Vector2d;

constexpr double kMargin = 36, kLeft = 66, kGap = 30, kTitle = 34, kFoot = 34, kAxisTitle = 26;  // design px
constexpr double kMostPxPerM = 520, kLeastWidth = 1000;

/// Equal drawings in lines and columns.
struct Sheet {
  double unit = 1, px_per_m = 1;
  PlaneBox window;  ///< that every drawing shows: across the row, and height
  int columns = 1, lines = 1, width = 0, height = 0;
  Vector2d first = Vector2d::Zero(), size = Vector2d::Zero();  ///< top left drawing, px

  double title() const { return kTitle * unit; }
  double foot() const { return kFoot * unit; }
  Vector2d corner(int i) const {
    const int line = i / columns, column = i % columns;
    return first + Vector2d(column * (size.x() + kGap * unit), line * (size.y() + title() + foot()));
  }
  double x(double across_m) const { return px_per_m * (across_m - window.low.x()); }
  double y(double height_m) const { return px_per_m * (window.high.y() - height_m); }
};

/// What the rows have of values, all in one window, from the ground up.
PlaneBox window_of(std::span<const LabelledSection> rows) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  PlaneBox window{{kInfinite, 0}, {-kInfinite, 0.5}};
  for (const LabelledSection& row : rows) {
    PlaneBox own;
    if (!value_bounds(row.section->grid, own)) continue;
    window.low = window.low.cwiseMin(own.low), window.high = window.high.cwiseMax(own.high);
  }
  if (!(window.low.x() < window.high.x())) window.low.x() = -0.5, window.high.x() = 0.5;
  return window;
}

/// The number of columns with which the drawings come out largest.
Sheet arrange(std::span<const LabelledSection> rows, const PictureOptions& options) {
  Sheet sheet;
  sheet.window = window_of(rows);
  const double unit = sheet.unit = options.width_px / 1600.0;
  const int count = static_cast<int>(rows.size());
  const double left = (kMargin + kLeft) * unit,
               top = std::max(elements::header_height(options, kMargin * unit, unit), (kMargin + 78) * unit);
  const double wide = options.width_px - left - kMargin * unit;
  const double high = options.max_height_px - top - (kAxisTitle + 0.6 * kMargin) * unit;
  const Vector2d metres = sheet.window.size();
  sheet.px_per_m = 0;
  for (int columns = 1; columns <= count; ++columns) {
    const int lines = (count + columns - 1) / columns;
    const double by_width = (wide - (columns - 1) * kGap * unit) / (columns * metres.x());
    const double by_height = (high / lines - sheet.title() - sheet.foot()) / metres.y();
    const double px_per_m = std::min({by_width, by_height, kMostPxPerM * unit});
    if (px_per_m <= sheet.px_per_m * (1 + 1e-9)) continue;
    sheet.px_per_m = px_per_m, sheet.columns = columns, sheet.lines = lines;
  }
  // Very many rows: the sheet becomes higher than asked for rather than illegible.
  sheet.px_per_m = std::max(sheet.px_per_m, 30 * unit);
  sheet.size = (sheet.px_per_m * metres).array().floor().max(1);
  sheet.columns = std::clamp(static_cast<int>((wide + kGap * unit) / (sheet.size.x() + kGap * unit)), 1, sheet.columns);
  sheet.lines = (count + sheet.columns - 1) / sheet.columns;
  sheet.first = {std::round(left), std::round(top + sheet.title())};
  const Vector2d last = sheet.corner(sheet.lines * sheet.columns - 1) + sheet.size;
  const double used = sheet.corner(sheet.columns - 1).x() + sheet.size.x() + kMargin * unit;
  sheet.width = static_cast<int>(std::ceil(std::max(used, kLeastWidth * unit)));
  sheet.height = static_cast<int>(std::ceil(last.y() + sheet.foot() + (kAxisTitle + 0.6 * kMargin) * unit));
  return sheet;
}

struct Ticks {
  std::vector<double> values;
  double step = 1;
};
Ticks ticks_between(double low, double high, double px_per_m, double room_px) {
  Ticks ticks;
  ticks.values = nice_ticks(low, high, std::clamp(static_cast<int>((high - low) * px_per_m / room_px), 1, 10));
  if (ticks.values.size() > 1) ticks.step = ticks.values[1] - ticks.values[0];
  return ticks;
}

void draw_axes(Canvas& canvas, const Sheet& sheet, const Vector2d& corner, bool with_heights) {
  const double unit = sheet.unit, foot = corner.y() + sheet.size.y();
  const StrokeStyle mark{elements::kFrameGrey, 1.2 * unit, 0};
  TextStyle style{15 * unit, elements::kGrey, false, Align::middle, Align::start};
  const Ticks across = ticks_between(sheet.window.low.x(), sheet.window.high.x(), sheet.px_per_m, 52 * unit);
  for (const double tick : across.values) {
    const double x = corner.x() + sheet.x(tick);
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(x, foot), Vector2d(x, foot + 6 * unit)}, mark);
    canvas.text({x, foot + 11 * unit}, tick_text(tick, across.step), style);
  }
  style.horizontal = Align::end, style.vertical = Align::middle;
  const Ticks heights = ticks_between(sheet.window.low.y(), sheet.window.high.y(), sheet.px_per_m, 40 * unit);
  for (const double tick : heights.values) {
    const double y = corner.y() + sheet.y(tick);
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(corner.x() - 6 * unit, y), Vector2d(corner.x(), y)}, mark);
    if (with_heights) canvas.text({corner.x() - 11 * unit, y}, tick_text(tick, heights.step), style);
  }
}

void draw_row(Canvas& canvas, const Sheet& sheet, const LabelledSection& row, int i, const ColorScale& scale) {
  const double unit = sheet.unit;
  const Vector2d corner = sheet.corner(i).array().round(), size = sheet.size;
  const auto width = static_cast<int>(size.x()), height = static_cast<int>(size.y());
  canvas.hatch(corner, size);
  canvas.image(static_cast<int>(corner.x()), static_cast<int>(corner.y()), width, height,
               render_grid(row.section->grid, scale, sheet.window, width, height));
  const auto line = [&](const Vector2d& from, const Vector2d& to, const StrokeStyle& style) {
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(corner + from), Vector2d(corner + to)}, style);
  };
  line({sheet.x(0), 0}, {sheet.x(0), size.y()}, {{70, 60, 50, 130}, 1.4 * unit, 5 * unit});
  elements::frame(canvas, corner, size, unit);
  line({0, sheet.y(0)}, {size.x(), sheet.y(0)}, {{106, 76, 48, 255}, 2.4 * unit, 0});
  canvas.text(corner - Vector2d(0, 9 * unit), row.label, {18 * unit, elements::kInk, true, Align::start, Align::end});
  draw_axes(canvas, sheet, corner, i % sheet.columns == 0);
}

}  // namespace

Result<void> draw_end_on(std::span<const LabelledSection> rows, const std::string& path,
                         const PictureOptions& options) {
  RAYFIELD_ASSIGN(const SectionRange range, check_sections(rows, path));
  const SectionProduct& first = *rows.front().section;
  const ColorScale scale = options.scale.value_or(product_scale(first.name, range.low, range.high));
  const Sheet sheet = arrange(rows, options);
  RAYFIELD_ASSIGN(Canvas canvas, Canvas::create(sheet.width, sheet.height, {255, 255, 255, 255}, format_of(path)));
  const double unit = sheet.unit, margin = kMargin * unit;
  elements::header(canvas, options, margin, unit);
  draw_section_legend(canvas, {sheet.width, margin, unit, range.beyond(scale)}, first, options, scale);
  for (std::size_t i = 0; i < rows.size(); ++i) draw_row(canvas, sheet, rows[i], static_cast<int>(i), scale);
  const TextStyle style{16 * unit, elements::kGrey, false, Align::start, Align::start};
  canvas.text({sheet.first.x(), sheet.height - (kAxisTitle + 0.4 * kMargin) * unit},
              "mean along each row; across it, m, positive to the left of its direction, dashed: the row's line",
              style);
  canvas.text({margin + 4 * unit, sheet.first.y() + sheet.size.y() / 2}, "height, m",
              {16 * unit, elements::kGrey, false, Align::middle, Align::middle, M_PI / 2, 0});
  return canvas.write(path);
}

}  // namespace rayfield::formats
