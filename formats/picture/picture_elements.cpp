#include "formats/picture/picture_elements.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayfield::formats::elements {
namespace {

using Eigen::Vector2d;
constexpr double kTitle_px = 34, kSubtitle_px = 21, kTick_px = 18;

double tick_step(const std::vector<double>& ticks) { return ticks.size() > 1 ? ticks[1] - ticks[0] : 1.0; }

}  // namespace

double header_height(const PictureOptions& options, double margin_px, double unit_px) {
  double y = margin_px;
  if (!options.title.empty()) y += (0.73 * kTitle_px + 18) * unit_px;
  if (!options.subtitle.empty()) y += (0.73 * kSubtitle_px + 18) * unit_px;
  return y;
}

double header(Canvas& canvas, const PictureOptions& options, double margin_px, double unit_px) {
  double y = margin_px;
  TextStyle style{kTitle_px * unit_px, kInk, true, Align::start, Align::start};
  if (!options.title.empty()) {
    canvas.text({margin_px, y}, options.title, style);
    y += (0.73 * kTitle_px + 18) * unit_px;
  }
  if (!options.subtitle.empty()) {
    style = {kSubtitle_px * unit_px, kGrey, false, Align::start, Align::start};
    canvas.text({margin_px, y}, options.subtitle, style);
  }
  return header_height(options, margin_px, unit_px);
}

std::vector<std::string> wrap(const Canvas& canvas, std::string_view text, const TextStyle& style, double width_px) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t space = text.find(' ');
    const std::string word(text.substr(0, space));
    text.remove_prefix(space == std::string_view::npos ? text.size() : space + 1);
    const std::string longer = lines.empty() ? word : lines.back() + " " + word;
    if (!lines.empty() && canvas.text_width_px(longer, style) <= width_px) {
      lines.back() = longer;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

std::string product_title(std::string_view product) {
  if (product == "plan_density") return "Canopy density";
  if (product == "leaf_density") return "Leaf density";
  if (product == "plan_density_se") return "Canopy density, standard error";
  if (product == "canopy_height") return "Canopy height";
  if (product == "plan_density_change") return "Change of canopy density";
  if (product == "canopy_height_change") return "Change of canopy height";
  if (product == "ground") return "Ground height";
  if (product.starts_with("side_view")) return "Canopy density, side view";
  if (product.starts_with("end_on")) return "Canopy density, end-on";
  return std::string(product);
}

/// Both bars have whole pixels and square ends that turn into triangles where values go beyond the scale; the number of
/// ticks follows from the length.
void vertical_bar(Canvas& canvas, const ColorScale& scale, const Vector2d& corner, const Vector2d& size,
                  const BarEnds& ends, double unit_px) {
  const auto width = static_cast<int>(std::lround(size.x())), height = static_cast<int>(std::lround(size.y()));
  const double x = std::round(corner.x()), y = std::round(corner.y()), tip = 0.5 * width;
  std::vector<Rgba> pixels;
  for (int i = 0; i < height; ++i) {
    const double value = scale.high - (i + 0.5) / height * (scale.high - scale.low);
    pixels.insert(pixels.end(), static_cast<std::size_t>(width), color_at(scale, value));
  }
  canvas.image(static_cast<int>(x), static_cast<int>(y), width, height, pixels);
  std::vector<Vector2d> outline = {{x, y + height}, {x, y}};
  if (ends.above) {
    const std::array<Vector2d, 3> triangle = {Vector2d(x, y), Vector2d(x + tip, y - tip), Vector2d(x + width, y)};
    canvas.polygon(triangle, color_at(scale, scale.high));
    outline.push_back(triangle[1]);
  }
  outline.insert(outline.end(), {Vector2d(x + width, y), Vector2d(x + width, y + height)});
  if (ends.below) {
    const std::array<Vector2d, 3> triangle = {Vector2d(x, y + height), Vector2d(x + tip, y + height + tip),
                                              Vector2d(x + width, y + height)};
    canvas.polygon(triangle, color_at(scale, scale.low));
    outline.push_back(triangle[1]);
  }
  canvas.polyline(outline, {kFrameGrey, 1.2 * unit_px, 0}, true);
  const std::vector<double> ticks =
      nice_ticks(scale.low, scale.high, std::clamp(height / static_cast<int>(50 * unit_px), 2, 8));
  for (const double tick : ticks) {
    const double ty = y + height * (scale.high - tick) / (scale.high - scale.low);
    const std::array<Vector2d, 2> mark = {Vector2d(x + width, ty), Vector2d(x + width + 7 * unit_px, ty)};
    canvas.polyline(mark, {kGrey, 1.2 * unit_px, 0});
    canvas.text({x + width + 12 * unit_px, ty}, tick_text(tick, tick_step(ticks)),
                {kTick_px * unit_px, kInk, false, Align::start, Align::middle});
  }
}

/// As vertical_bar(), turned by 90°.
void horizontal_bar(Canvas& canvas, const ColorScale& scale, const Vector2d& corner, const Vector2d& size,
                    const BarEnds& ends, double unit_px) {
  const auto width = static_cast<int>(std::lround(size.x())), height = static_cast<int>(std::lround(size.y()));
  const double x = std::round(corner.x()), y = std::round(corner.y()), tip = 0.5 * height;
  std::vector<Rgba> row, pixels;
  for (int i = 0; i < width; ++i) {
    row.push_back(color_at(scale, scale.low + (i + 0.5) / width * (scale.high - scale.low)));
  }
  for (int i = 0; i < height; ++i) pixels.insert(pixels.end(), row.begin(), row.end());
  canvas.image(static_cast<int>(x), static_cast<int>(y), width, height, pixels);
  std::vector<Vector2d> outline = {{x, y}, {x + width, y}};
  if (ends.above) {
    const std::array<Vector2d, 3> triangle = {Vector2d(x + width, y), Vector2d(x + width + tip, y + tip),
                                              Vector2d(x + width, y + height)};
    canvas.polygon(triangle, color_at(scale, scale.high));
    outline.push_back(triangle[1]);
  }
  outline.insert(outline.end(), {Vector2d(x + width, y + height), Vector2d(x, y + height)});
  if (ends.below) {
    const std::array<Vector2d, 3> triangle = {Vector2d(x, y), Vector2d(x - tip, y + tip), Vector2d(x, y + height)};
    canvas.polygon(triangle, color_at(scale, scale.low));
    outline.push_back(triangle[1]);
  }
  canvas.polyline(outline, {kFrameGrey, 1.2 * unit_px, 0}, true);
  const std::vector<double> ticks =
      nice_ticks(scale.low, scale.high, std::clamp(width / static_cast<int>(60 * unit_px), 2, 8));
  for (const double tick : ticks) {
    const double tx = x + width * (tick - scale.low) / (scale.high - scale.low);
    const std::array<Vector2d, 2> mark = {Vector2d(tx, y + height), Vector2d(tx, y + height + 6 * unit_px)};
    canvas.polyline(mark, {kGrey, 1.2 * unit_px, 0});
    canvas.text({tx, y + height + 11 * unit_px}, tick_text(tick, tick_step(ticks)),
                {kTick_px * unit_px, kInk, false, Align::middle, Align::start});
  }
}

double not_scanned_key(Canvas& canvas, const Vector2d& corner, double unit_px) {
  const Vector2d size(34 * unit_px, 22 * unit_px);
  canvas.hatch(corner, size);
  frame(canvas, corner, size, unit_px);
  const TextStyle style{kTick_px * unit_px, kInk, false, Align::start, Align::middle};
  canvas.text(corner + Vector2d(size.x() + 12 * unit_px, size.y() / 2), "not scanned", style);
  return size.x() + 12 * unit_px + canvas.text_width_px("not scanned", style);
}

void scale_bar(Canvas& canvas, const Vector2d& corner, double px_per_m, double max_px, double unit_px) {
  double length_m = 0;
  for (const double candidate : nice_ticks(0, max_px / px_per_m, 2)) length_m = candidate;
  if (!(length_m > 0)) return;
  // The largest round length: nice_ticks gives multiples of a step, of which 1, 2 and 5 × 10ⁿ read best.
  const double power = std::pow(10.0, std::floor(std::log10(max_px / px_per_m)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power * px_per_m <= max_px) length_m = factor * power;
  }
  const double length_px = length_m * px_per_m, height = 8 * unit_px;
  const Vector2d top = corner - Vector2d(0, height);
  canvas.rectangle(top, {length_px, height}, {255, 255, 255, 255});
  canvas.rectangle(top, {length_px / 2, height}, kInk);
  const std::array<Vector2d, 4> outline = {top, top + Vector2d(length_px, 0), top + Vector2d(length_px, height),
                                           corner};
  canvas.polyline(outline, {kInk, 1.4 * unit_px, 0}, true);
  canvas.text(top + Vector2d(length_px / 2, -8 * unit_px), tick_text(length_m, length_m) + " m",
              {kTick_px * unit_px, kInk, false, Align::middle, Align::end});
}

void north_arrow(Canvas& canvas, const Vector2d& foot, double height_px) {
  const double arrow = 0.66 * height_px, half = 0.2 * height_px;
  const Vector2d tip = foot - Vector2d(0, arrow), notch = foot - Vector2d(0, 0.22 * arrow);
  const std::array<Vector2d, 3> left = {tip, notch, foot + Vector2d(-half, 0)};
  const std::array<Vector2d, 3> right = {tip, notch, foot + Vector2d(half, 0)};
  canvas.polygon(left, kInk);
  canvas.polygon(right, {255, 255, 255, 255});
  canvas.polyline(right, {kInk, 0.025 * height_px, 0}, true);
  canvas.polyline(left, {kInk, 0.025 * height_px, 0}, true);
  canvas.text(tip - Vector2d(0, 0.1 * height_px), "N", {0.3 * height_px, kInk, true, Align::middle, Align::end});
}

void frame(Canvas& canvas, const Vector2d& corner, const Vector2d& size, double unit_px) {
  const std::array<Vector2d, 4> outline = {corner, corner + Vector2d(size.x(), 0), corner + size,
                                           corner + Vector2d(0, size.y())};
  canvas.polyline(outline, {kFrameGrey, 1.2 * unit_px, 0}, true);
}

}  // namespace rayfield::formats::elements
