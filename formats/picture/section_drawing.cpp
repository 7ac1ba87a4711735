#include "formats/picture/section_drawing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/picture/color.h"
#include "formats/picture/picture_elements.h"
#include "formats/picture/render_grid.h"

namespace rayfield::formats {
namespace {

using Eigen::Vector2d;
using elements::kPictureWhat;

/// Part of one section, drawn in one piece.
struct Piece {
  const LabelledSection* source = nullptr;
  double begin_m = 0, end_m = 0;
  bool continued = false;
  Vector2d corner = Vector2d::Zero();  ///< top left of the drawing, px
  bool first_in_line = false, last_of_stretch = true;
};

/// All sections share proportions, heights and colours.
struct Stack {
  std::vector<Piece> pieces;
  double unit = 1, margin = 36, left = 0, top = 0;
  double low_m = 0, high_m = 2;  ///< range of heights shown
  double px_per_m = 1;
  int width = 0, height = 0;

  double drawing_height() const { return std::round(px_per_m * (high_m - low_m)); }
  double line_height() const { return drawing_height() + 84 * unit; }
  /// Of a drawing without an axis below it.
  double stacked_height() const { return drawing_height() + 46 * unit; }
};

Vector2d x_range(const Grid2<float>& grid) { return {grid.origin.x(), grid.origin.x() + grid.cell_m * grid.nx}; }

void find_heights(std::span<const LabelledSection> sections, Stack& stack) {
  double low = 0, high = 0.5;
  for (const LabelledSection& s : sections) {
    PlaneBox box;
    if (!value_bounds(s.section->grid, box)) continue;
    low = std::min(low, box.low.y());
    high = std::max(high, box.high.y());
  }
  stack.low_m = low;
  stack.high_m = high;
}

/// Length of the pieces that a section is cut into: the section itself where it fits, else equal whole metres, so that
/// the ticks of continued lines stay round.
double piece_length(double length_m, double available_m) {
  for (int count = 1; count < 100000; ++count) {
    const double share = count == 1 ? length_m : std::ceil(length_m / count);
    if (share <= available_m * (1 + 1e-6) || share <= 1) return share;
  }
  return length_m;
}

int piece_count(double length_m, double piece_m) { return static_cast<int>(std::ceil((length_m - 1e-6) / piece_m)); }

/// Cuts the sections into pieces that fit the width at this scale and sets them line by line; returns the height used.
double set_pieces(std::span<const LabelledSection> sections, Stack& stack, double available_px) {
  stack.pieces.clear();
  double x = 0, y = stack.top;
  bool line_empty = true;
  for (const LabelledSection& s : sections) {
    const Vector2d range = x_range(s.section->grid);
    const double length = range.y() - range.x();
    const double share = piece_length(length, available_px / stack.px_per_m);
    for (int k = 0; k < piece_count(length, share); ++k) {
      const double begin = range.x() + k * share;
      Piece piece{&s, begin, std::min(begin + share, range.y()), begin > range.x(), {}, false};
      const double width = stack.px_per_m * (piece.end_m - piece.begin_m);
      if (!line_empty && x + width > available_px + 1) {
        x = 0;
        y += stack.line_height();
        line_empty = true;
      }
      piece.corner = {std::round(stack.left + x), std::round(y + 34 * stack.unit)};
      piece.first_in_line = line_empty;
      stack.pieces.push_back(piece);
      x += width + 46 * stack.unit;
      line_empty = false;
    }
  }
  return y + stack.line_height();
}

/// From the first beginning to the last end.
Vector2d common_range(std::span<const LabelledSection> sections) {
  Vector2d range = x_range(sections.front().section->grid);
  for (const LabelledSection& s : sections) {
    const Vector2d own = x_range(s.section->grid);
    range = {std::min(range.x(), own.x()), std::max(range.y(), own.y())};
  }
  return range;
}

/// The same stretch of all sections under each other, then the next stretch; returns the height used.
double set_stacked(std::span<const LabelledSection> sections, Stack& stack, double available_px) {
  stack.pieces.clear();
  const Vector2d range = common_range(sections);
  const double share = piece_length(range.y() - range.x(), available_px / stack.px_per_m);
  double y = stack.top;
  for (int k = 0; k < piece_count(range.y() - range.x(), share); ++k) {
    const double begin = range.x() + k * share;
    for (const LabelledSection& s : sections) {
      Piece piece{&s, begin, std::min(begin + share, range.y()), begin > range.x(), {}, true};
      piece.corner = {std::round(stack.left), std::round(y + 34 * stack.unit)};
      piece.last_of_stretch = &s == &sections.back();
      stack.pieces.push_back(piece);
      y += piece.last_of_stretch ? stack.line_height() : stack.stacked_height();
    }
  }
  return y;
}

Stack arrange(std::span<const LabelledSection> sections, SectionOrder order, const PictureOptions& options) {
  Stack stack;
  stack.unit = options.width_px / 1600.0;
  stack.margin *= stack.unit;
  stack.left = stack.margin + 52 * stack.unit;
  stack.top = std::max(elements::header_height(options, stack.margin, stack.unit), stack.margin + 84 * stack.unit);
  find_heights(sections, stack);
  const double available = options.width_px - stack.left - stack.margin;
  const Vector2d common = common_range(sections);
  double longest = order == SectionOrder::stacked ? common.y() - common.x() : 0;
  for (const LabelledSection& s : sections)
    longest = std::max(longest, x_range(s.section->grid).y() - x_range(s.section->grid).x());
  const auto set = order == SectionOrder::stacked ? set_stacked : set_pieces;
  // At least 45 design pixels a metre: longer sections are continued on the next line. At most 150.
  const double lines = std::max(1.0, std::ceil(longest * 45 * stack.unit / available));
  stack.px_per_m = std::min(available / (lines > 1 ? std::ceil(longest / lines) : longest), 150 * stack.unit);
  double bottom = set(sections, stack, available);
  while (bottom + stack.margin > options.max_height_px && stack.px_per_m > 4 * stack.unit) {
    stack.px_per_m *= 0.92;
    bottom = set(sections, stack, available);
  }
  stack.width = options.width_px;
  stack.height = static_cast<int>(std::ceil(bottom + 0.4 * stack.margin));
  return stack;
}

void draw_height_axis(Canvas& canvas, const Stack& stack, const Piece& piece) {
  const double unit = stack.unit;
  const auto ticks =
      nice_ticks(stack.low_m, stack.high_m, std::clamp(static_cast<int>(stack.drawing_height() / (30 * unit)), 1, 5));
  for (const double tick : ticks) {
    const double y = piece.corner.y() + stack.px_per_m * (stack.high_m - tick), x = piece.corner.x();
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(x - 6 * unit, y), Vector2d(x, y)},
                    {elements::kFrameGrey, 1.2 * unit, 0});
    canvas.text({x - 11 * unit, y}, tick_text(tick, ticks.size() > 1 ? ticks[1] - ticks[0] : 1),
                {15 * unit, elements::kGrey, false, Align::end, Align::middle});
  }
  canvas.text({stack.margin + 4 * unit, piece.corner.y() + stack.drawing_height() / 2}, "height, m",
              {14 * unit, elements::kGrey, false, Align::middle, Align::middle, M_PI / 2, 0});
}

void draw_distance_axis(Canvas& canvas, const Stack& stack, const Piece& piece) {
  const double unit = stack.unit, y = piece.corner.y() + stack.drawing_height();
  const double width = stack.px_per_m * (piece.end_m - piece.begin_m);
  const auto ticks = nice_ticks(piece.begin_m, piece.end_m, std::max(1, static_cast<int>(width / (55 * unit))));
  const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : 1;
  const double slack = 1e-6 * step;
  for (const double tick : ticks) {
    const double x = piece.corner.x() + stack.px_per_m * (tick - piece.begin_m);
    const bool last = tick + step > piece.end_m + slack;
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(x, y), Vector2d(x, y + 6 * unit)},
                    {elements::kFrameGrey, 1.2 * unit, 0});
    canvas.text({x, y + 11 * unit}, tick_text(tick, step) + (last ? " m" : ""),
                {15 * unit, elements::kGrey, false, Align::middle, Align::start});
  }
}

void draw_piece(Canvas& canvas, const Stack& stack, const Piece& piece, const ColorScale& scale) {
  const double unit = stack.unit;
  const Vector2d size(std::round(stack.px_per_m * (piece.end_m - piece.begin_m)), stack.drawing_height());
  const auto width = std::max(1, static_cast<int>(size.x())), height = std::max(1, static_cast<int>(size.y()));
  canvas.hatch(piece.corner, size);
  const PlaneBox window{{piece.begin_m, stack.low_m}, {piece.end_m, stack.high_m}};
  canvas.image(static_cast<int>(piece.corner.x()), static_cast<int>(piece.corner.y()), width, height,
               render_grid(piece.source->section->grid, scale, window, width, height));
  for (const double mark : piece.source->marks_m) {
    if (mark < piece.begin_m || mark > piece.end_m) continue;
    const double x = piece.corner.x() + stack.px_per_m * (mark - piece.begin_m);
    canvas.polyline(std::array<Vector2d, 2>{Vector2d(x, piece.corner.y()), Vector2d(x, piece.corner.y() + size.y())},
                    {{70, 60, 50, 130}, 1.4 * unit, 5 * unit});
  }
  elements::frame(canvas, piece.corner, size, unit);
  const double ground = piece.corner.y() + stack.px_per_m * stack.high_m;
  canvas.polyline(
      std::array<Vector2d, 2>{Vector2d(piece.corner.x(), ground), Vector2d(piece.corner.x() + size.x(), ground)},
      {{106, 76, 48, 255}, 2.4 * unit, 0});
  const std::string label = piece.continued ? piece.source->label + " (continued)" : piece.source->label;
  canvas.text(
      piece.corner - Vector2d(0, 9 * unit), label,
      {18 * unit, piece.continued ? elements::kGrey : elements::kInk, !piece.continued, Align::start, Align::end});
  if (piece.last_of_stretch) draw_distance_axis(canvas, stack, piece);
  if (piece.first_in_line) draw_height_axis(canvas, stack, piece);
}

}  // namespace

void draw_section_legend(Canvas& canvas, const SectionSheet& sheet, const SectionProduct& section,
                         const PictureOptions& options, const ColorScale& scale) {
  const double unit = sheet.unit, width = 400 * unit;
  const double x = sheet.width_px - sheet.margin - width - 12 * unit, y = sheet.margin;
  const std::string meaning = options.legend.empty() ? elements::product_title(section.name) : options.legend;
  canvas.text({x, y}, meaning + ", " + pretty_unit(section.unit),
              {17 * unit, elements::kInk, false, Align::start, Align::start});
  elements::horizontal_bar(canvas, scale, {x, y + 24 * unit}, {width, 22 * unit}, sheet.ends, unit);
  elements::not_scanned_key(canvas, {x - 190 * unit, y + 24 * unit}, unit);
}

Result<SectionRange> check_sections(std::span<const LabelledSection> sections, const std::string& path) {
  if (sections.empty()) return fail(ErrorCode::usage, kPictureWhat, path, "there are no sections to draw");
  SectionRange range;
  for (const LabelledSection& labelled : sections) {
    const SectionProduct* section = labelled.section;
    const bool good = section != nullptr && section->grid.nx > 0 && section->grid.ny > 0 && section->grid.cell_m > 0 &&
                      section->grid.origin.allFinite() &&
                      section->grid.values.size() ==
                          static_cast<std::size_t>(section->grid.nx) * static_cast<std::size_t>(section->grid.ny);
    if (!good)
      return fail(ErrorCode::internal, kPictureWhat, path, "a section has no cells or its size is inconsistent");
    const auto [low, high] = value_range(section->grid);
    range.low = std::fmin(range.low, low);
    range.high = std::fmax(range.high, high);
  }
  return range;
}

Result<void> draw_sections(std::span<const LabelledSection> sections, SectionOrder order, const std::string& path,
                           const PictureOptions& options) {
  RAYFIELD_ASSIGN(const SectionRange range, check_sections(sections, path));
  const SectionProduct& first = *sections.front().section;
  const ColorScale scale = options.scale.value_or(product_scale(first.name, range.low, range.high));
  const Stack stack = arrange(sections, order, options);
  RAYFIELD_ASSIGN(Canvas canvas, Canvas::create(stack.width, stack.height, {255, 255, 255, 255}, format_of(path)));
  elements::header(canvas, options, stack.margin, stack.unit);
  draw_section_legend(canvas, {stack.width, stack.margin, stack.unit, range.beyond(scale)}, first, options, scale);
  for (const Piece& piece : stack.pieces) draw_piece(canvas, stack, piece, scale);
  return canvas.write(path);
}

}  // namespace rayfield::formats
