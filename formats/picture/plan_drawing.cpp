#include "formats/picture/plan_drawing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "formats/picture/color.h"
#include "formats/picture/picture_elements.h"
#include "formats/picture/render_grid.h"

namespace rayfield::formats {
namespace {

using Eigen::Vector2d;
using elements::kPictureWhat;

/// Where everything goes, px.
struct Layout {
  double unit = 1, margin = 36;
  int width = 0, height = 0;
  Vector2d map_corner = Vector2d::Zero(), map_size = Vector2d::Zero();
  PlaneBox window;  ///< what the map shows
  double px_per_m = 1;
  double column_x = 0, column_width = 0;  ///< legend on the right

  Vector2d px(const Vector2d& p_in_map) const {
    return map_corner + px_per_m * Vector2d(p_in_map.x() - window.low.x(), window.high.y() - p_in_map.y());
  }
};

void extend(PlaneBox& box, const Vector2d& p) {
  box.low = box.low.cwiseMin(p);
  box.high = box.high.cwiseMax(p);
}

/// What there is to see, with a margin; false where there is nothing.
bool find_window(const Plan& plan, PlaneBox& box) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  box = {Vector2d(kInfinite, kInfinite), Vector2d(-kInfinite, -kInfinite)};
  if (plan.raster != nullptr) {
    const Grid2<float>& grid = plan.raster->grid;
    const PlaneBox whole{grid.origin, grid.origin + grid.cell_m * Vector2d(grid.nx, grid.ny)};
    PlaneBox data;
    const bool cropped = plan.options.crop_to_data && value_bounds(grid, data);
    extend(box, cropped ? data.low : whole.low);
    extend(box, cropped ? data.high : whole.high);
  }
  for (const PlanLine& line : plan.overlay.lines) {
    for (const Vector2d& p : line.points) extend(box, p);
  }
  for (const PlanArea& area : plan.overlay.areas)
    for (const auto& ring : area.rings)
      for (const Vector2d& p : ring) extend(box, p);
  for (const PlanMarker& marker : plan.overlay.markers) extend(box, marker.position);
  for (const PlanLabel& label : plan.overlay.labels) extend(box, label.position);
  if (!box.low.allFinite() || !box.high.allFinite()) return false;
  // Beyond any map; pixels would no longer be distinct.
  if (box.low.minCoeff() < -1e9 || box.high.maxCoeff() > 1e9) return false;
  const double border = std::max(1.0, 0.03 * box.size().maxCoeff());
  box.low.array() -= border;
  box.high.array() += border;
  return true;
}

Layout arrange(const Plan& plan, const PlaneBox& wanted) {
  Layout layout;
  layout.unit = plan.options.width_px / 1600.0;
  const double unit = layout.unit;
  layout.margin *= unit;
  const bool legend = plan.raster != nullptr || !plan.overlay.keys.empty();
  layout.column_width = (legend ? 215 : 90) * unit;
  const double axis = plan.options.coordinates ? 34 * unit : 0;
  const double top =
      elements::header_height(plan.options, layout.margin, unit) + (plan.options.title.empty() ? 0 : 8 * unit);
  layout.map_corner = {std::round(layout.margin + axis), std::round(top)};
  const double most_wide = plan.options.width_px - layout.map_corner.x() - layout.column_width - 1.6 * layout.margin;
  const double most_high = plan.options.max_height_px - layout.map_corner.y() - axis - layout.margin;
  const double least_high =
      (plan.raster != nullptr ? 470 : 200) * unit + 30 * unit * static_cast<double>(plan.overlay.keys.size());
  const Vector2d size = wanted.size();
  layout.px_per_m = std::min(most_wide / size.x(), most_high / size.y());
  // The frame never gets too narrow for a title or too low for the legend; it then shows more of the surroundings.
  layout.map_size.x() = std::round(std::max(layout.px_per_m * size.x(), 0.5 * most_wide));
  layout.map_size.y() = std::round(std::max(layout.px_per_m * size.y(), std::min(least_high, most_high)));
  const Vector2d half = layout.map_size / (2 * layout.px_per_m), middle = (wanted.low + wanted.high) / 2;
  layout.window = {middle - half, middle + half};
  layout.column_x = layout.map_corner.x() + layout.map_size.x() + 0.8 * layout.margin;
  layout.width = static_cast<int>(std::ceil(layout.column_x + layout.column_width + 0.8 * layout.margin));
  layout.height = static_cast<int>(std::ceil(layout.map_corner.y() + layout.map_size.y() + axis + layout.margin));
  return layout;
}

/// 276200 → "276 200" with thin spaces.
std::string grouped(double value, double step) {
  std::string text = tick_text(value, step);
  const std::size_t dot = std::min(text.find('.'), text.size());
  const std::size_t first = !text.empty() && text[0] == '-' ? 1 : 0;
  for (std::size_t i = dot; i > first + 3; i -= 3) text.insert(i - 3, "\u2009");
  return text;
}

/// Labels need room: ticks whose label would stand out beyond the frame are left out.
struct Axis {
  std::vector<double> ticks;
  double step = 1;
};
Axis axis_ticks(double low_m, double high_m, double step_m, double label_px, double px_per_m) {
  Axis axis{{}, step_m};
  const double inset = 0.5 * label_px / px_per_m;
  for (const double tick : nice_ticks(low_m, high_m, static_cast<int>(std::ceil((high_m - low_m) / step_m)))) {
    if (tick >= low_m + inset && tick <= high_m - inset) axis.ticks.push_back(tick);
  }
  return axis;
}

void draw_axes(Canvas& canvas, const Layout& layout, bool grid_lines) {
  const double unit = layout.unit;
  const StrokeStyle mark{elements::kFrameGrey, 1.2 * unit, 0}, line{{226, 229, 232, 255}, 1 * unit, 0};
  const Vector2d corner = layout.map_corner, size = layout.map_size;
  const PlaneBox& window = layout.window;
  // One step for both axes, so that grid lines make squares.
  const double label_px = 110 * unit;
  const auto steps =
      nice_ticks(0, window.size().minCoeff(), std::max(1, static_cast<int>(size.minCoeff() / (1.6 * label_px))));
  const double step_m = steps.size() > 1 ? steps[1] : 1;
  TextStyle style{15 * unit, elements::kGrey, false, Align::middle, Align::start};
  const Axis eastings = axis_ticks(window.low.x(), window.high.x(), step_m, label_px, layout.px_per_m);
  for (const double easting : eastings.ticks) {
    const double x = layout.px({easting, window.low.y()}).x(), y = corner.y() + size.y();
    if (grid_lines) canvas.polyline(std::array<Vector2d, 2>{Vector2d(x, corner.y()), Vector2d(x, y)}, line);
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(x, y), Vector2d(x, y + 6 * unit)}, mark);
    canvas.text({x, y + 12 * unit}, grouped(easting, eastings.step) + " E", style);
  }
  style.rotation_rad = M_PI / 2;
  style.vertical = Align::end;
  const Axis northings = axis_ticks(window.low.y(), window.high.y(), step_m, label_px, layout.px_per_m);
  for (const double northing : northings.ticks) {
    const double x = corner.x(), y = layout.px({window.low.x(), northing}).y();
    if (grid_lines) canvas.polyline(std::array<Vector2d, 2>{Vector2d(x, y), Vector2d(x + size.x(), y)}, line);
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(x - 6 * unit, y), Vector2d(x, y)}, mark);
    canvas.text({x - 12 * unit, y}, grouped(northing, northings.step) + " N", style);
  }
}

void draw_marker(Canvas& canvas, const Vector2d& center, const PlanMarker& marker, double unit) {
  canvas.circle(center, (marker.radius_px + 1) * unit, {255, 255, 255, 200});
  canvas.circle(center, marker.radius_px * unit, marker.color);
}

TextStyle scaled(TextStyle style, double unit) {
  style.size_px *= unit;
  style.halo_px *= unit;
  return style;
}

/// The smallest k of 1, 2, 5 … for which every k-th of many things has room; 100 where none has.
template <class HasRoom>
int smallest_step(const HasRoom& has_room) {
  for (const int step : {1, 2, 5, 10, 20, 50})
    if (has_room(step)) return step;
  return 100;
}

/// Every k-th thing is shown; the first one too, unless the second is. `number`: from 1.
bool is_shown(int number, int every) { return number % every == 0 || (number == 1 && every != 2); }

/// Whether labels do not touch if every k-th is shown.
bool have_room(const Canvas& canvas, const Layout& layout, const std::vector<PlanLabel>& labels, int every) {
  std::vector<Eigen::AlignedBox2d> boxes;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!is_shown(static_cast<int>(i) + 1, every)) continue;
    const TextStyle style = scaled(labels[i].style, layout.unit);
    const Vector2d half(0.5 * canvas.text_width_px(labels[i].text, style) + 2 * layout.unit, 0.5 * style.size_px);
    const Vector2d center = layout.px(labels[i].position);
    const Eigen::AlignedBox2d box(center - half, center + half);
    if (std::any_of(boxes.begin(), boxes.end(), [&](const auto& other) { return other.intersects(box); })) return false;
    boxes.push_back(box);
  }
  return true;
}

/// Names of rows: all of them, or as many as have room.
void draw_labels(Canvas& canvas, const Layout& layout, const std::vector<PlanLabel>& labels) {
  const int every = smallest_step([&](int step) { return have_room(canvas, layout, labels, step); });
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (is_shown(static_cast<int>(i) + 1, every))
      canvas.text(layout.px(labels[i].position), labels[i].text, scaled(labels[i].style, layout.unit));
}

void draw_overlay(Canvas& canvas, const Layout& layout, const PlanOverlay& overlay) {
  const auto stroke = [&layout](StrokeStyle style) {
    style.width_px *= layout.unit;
    style.dash_px *= layout.unit;
    return style;
  };
  const auto in_px = [&layout](const std::vector<Vector2d>& line) {
    std::vector<Vector2d> points;
    for (const Vector2d& p : line) points.push_back(layout.px(p));
    return points;
  };
  for (const PlanArea& area : overlay.areas) {
    std::vector<std::vector<Vector2d>> rings;
    for (const auto& ring : area.rings) rings.push_back(in_px(ring));
    canvas.rings(rings, area.fill);
    for (const auto& ring : rings) canvas.polyline(ring, stroke(area.outline), true);
  }
  for (const PlanLine& line : overlay.lines) canvas.polyline(in_px(line.points), stroke(line.style), line.closed);
  for (const PlanMarker& marker : overlay.markers) {
    draw_marker(canvas, layout.px(marker.position), marker, layout.unit);
  }
  draw_labels(canvas, layout, overlay.labels);
}

/// Of every k-th thing, with the smallest k for which they do not touch.
void draw_numbers(Canvas& canvas, const Layout& layout, const PlanOverlay& overlay) {
  const TextStyle style{14 * layout.unit, {70, 76, 82, 255}, false, Align::middle, Align::middle, 0, 2 * layout.unit};
  const double high_px = style.size_px, wide_px = 1.5 * canvas.text_width_px("88", style);
  for (const PlanNumber& n : overlay.numbers) {
    if (n.across_m * layout.px_per_m < high_px) continue;
    const int every = smallest_step([&](int step) { return step * n.along_m * layout.px_per_m >= wide_px; });
    if (!is_shown(n.number, every)) continue;
    const Vector2d aside(n.aside.x(), -n.aside.y());
    canvas.text(layout.px(n.position) + 0.62 * high_px * aside, std::to_string(n.number), style);
  }
}

/// Legend from the top of the column, north arrow and scale bar at its bottom.
void draw_column(Canvas& canvas, const Layout& layout, const Plan& plan) {
  const double unit = layout.unit, x = layout.column_x, bottom = layout.map_corner.y() + layout.map_size.y();
  double y = layout.map_corner.y();
  if (plan.raster != nullptr) {
    const TextStyle heading{20 * unit, elements::kInk, true, Align::start, Align::start};
    const std::string text =
        plan.options.legend.empty() ? elements::product_title(plan.raster->name) : plan.options.legend;
    for (const std::string& line : elements::wrap(canvas, text, heading, layout.column_width)) {
      canvas.text({x, y}, line, heading);
      y += 27 * unit;
    }
    canvas.text({x, y}, pretty_unit(plan.raster->unit),
                {20 * unit, elements::kGrey, false, Align::start, Align::start});
    y += 44 * unit;
    const double below = (190 + 30 * static_cast<double>(plan.overlay.keys.size())) * unit;
    const double bar = std::clamp(bottom - y - below, 60 * unit, 420 * unit);
    elements::vertical_bar(canvas, plan.scale, {x, y}, {32 * unit, bar}, plan.ends, unit);
    y += bar + 40 * unit;
    elements::not_scanned_key(canvas, {x, y}, unit);
    y += 36 * unit;
  }
  for (const PlanKey& key : plan.overlay.keys) {
    StrokeStyle style = key.style;
    style.width_px *= unit;
    style.dash_px *= unit;
    const double middle = y + 11 * unit;
    if (key.fill) {
      const Vector2d corner(x, y), size(34 * unit, 22 * unit);
      canvas.rectangle(corner, size, *key.fill);
      canvas.polyline(std::array<Vector2d, 4>{corner, corner + Vector2d(size.x(), 0), corner + size,
                                              corner + Vector2d(0, size.y())},
                      style, true);
    } else if (key.markers.empty()) {
      canvas.polyline(std::array<Vector2d, 2>{Vector2d(x, middle), Vector2d(x + 34 * unit, middle)}, style);
    }
    for (const PlanMarker& marker : key.markers) draw_marker(canvas, {x + 17 * unit, middle}, marker, 1.5 * unit);
    canvas.text({x + 46 * unit, middle}, key.text, {18 * unit, elements::kInk, false, Align::start, Align::middle});
    y += 30 * unit;
  }
  elements::scale_bar(canvas, {x + unit, bottom - unit}, layout.px_per_m, layout.column_width - 75 * unit, unit);
  elements::north_arrow(canvas, {x + layout.column_width - 30 * unit, bottom - unit}, 72 * unit);
}

}  // namespace

Result<void> draw_plan(const Plan& plan, const std::string& path) {
  PlaneBox wanted;
  if (!find_window(plan, wanted)) {
    return fail(ErrorCode::usage, kPictureWhat, path,
                "there is nothing to draw, or a coordinate is not finite or beyond 1e9 m");
  }
  const Layout layout = arrange(plan, wanted);
  RAYFIELD_ASSIGN(Canvas canvas, Canvas::create(layout.width, layout.height, {255, 255, 255, 255}, format_of(path)));
  elements::header(canvas, plan.options, layout.margin, layout.unit);
  const Vector2d corner = layout.map_corner, size = layout.map_size;
  if (plan.raster != nullptr) {
    canvas.hatch(corner, size);
    const auto width = static_cast<int>(size.x()), height = static_cast<int>(size.y());
    canvas.image(static_cast<int>(corner.x()), static_cast<int>(corner.y()), width, height,
                 render_grid(plan.raster->grid, plan.scale, layout.window, width, height));
  } else {
    canvas.rectangle(corner, size, {250, 250, 248, 255});
  }
  if (plan.options.coordinates) draw_axes(canvas, layout, plan.raster == nullptr);
  canvas.clip(corner, size);
  draw_overlay(canvas, layout, plan.overlay);
  draw_numbers(canvas, layout, plan.overlay);
  canvas.unclip();
  elements::frame(canvas, corner, size, layout.unit);
  draw_column(canvas, layout, plan);
  return canvas.write(path);
}

}  // namespace rayfield::formats
