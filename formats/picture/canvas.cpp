#include "formats/picture/canvas.h"

#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <vector>

#include "formats/io/staged_output.h"
#include "formats/io/text_escape.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kWhat = "cannot draw picture";
constexpr int kMaxSide_px = 20000;
constexpr const char* kFontFamily = "DejaVu Sans";

void set_color(cairo_t* cairo, const Rgba& color) {
  cairo_set_source_rgba(cairo, color.r / 255.0, color.g / 255.0, color.b / 255.0, color.a / 255.0);
}

/// Fixed rendering of glyphs, whatever the user's desktop prefers: grey levels, no hinting.
void set_font(cairo_t* cairo, const TextStyle& style) {
  cairo_select_font_face(cairo, kFontFamily, CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, style.size_px);
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cairo, options);
  cairo_font_options_destroy(options);
}

void trace(cairo_t* cairo, std::span<const Eigen::Vector2d> points, bool closed) {
  cairo_new_path(cairo);
  for (const Eigen::Vector2d& p : points) cairo_line_to(cairo, p.x(), p.y());
  if (closed) cairo_close_path(cairo);
}

/// Cairo's pixel format: premultiplied, alpha in the high byte of a native 32-bit word.
std::uint32_t premultiplied(const Rgba& color) {
  const auto channel = [&color](unsigned value) { return (value * color.a + 127U) / 255U; };
  return static_cast<std::uint32_t>(color.a) << 24 | channel(color.r) << 16 | channel(color.g) << 8 | channel(color.b);
}

cairo_status_t append_bytes(void* closure, const unsigned char* data, unsigned length) {
  try {
    static_cast<std::string*>(closure)->append(data, data + length);
    return CAIRO_STATUS_SUCCESS;
  } catch (const std::bad_alloc&) {
    return CAIRO_STATUS_NO_MEMORY;
  }
}

/// Cairo numbers surfaces through the life of the process ("surface459"): numbered here through the file instead, so
/// that equal drawings are equal bytes.
std::string renumber_surfaces(const std::string& svg) {
  constexpr std::string_view kName = "surface";
  std::map<std::string, std::size_t> numbers;
  std::string out;
  std::size_t at = 0;
  for (std::size_t found; (found = svg.find(kName, at)) != std::string::npos;) {
    const std::size_t begin = found + kName.size();
    const std::size_t end = std::min(svg.size(), svg.find_first_not_of("0123456789", begin));
    out.append(svg, at, begin - at);
    if (end > begin) {
      const std::size_t number = numbers.emplace(svg.substr(begin, end - begin), numbers.size() + 1).first->second;
      out += std::to_string(number);
    }
    at = end;
  }
  return out.append(svg, at);
}

ErrorCode code_of(cairo_status_t status) {
  return status == CAIRO_STATUS_NO_MEMORY ? ErrorCode::resources : ErrorCode::internal;
}

}  // namespace

PictureFormat format_of(std::string_view path) {
  std::string ending(path.substr(path.size() < 4 ? 0 : path.size() - 4));
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".svg" ? PictureFormat::svg : PictureFormat::png;
}

struct Canvas::Impl {
  PictureFormat format = PictureFormat::png;
  std::string svg;  // grows while the surface lives
  cairo_surface_t* surface = nullptr;
  cairo_t* cairo = nullptr;
  int width = 0, height = 0;

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (cairo != nullptr) cairo_destroy(cairo);
    if (surface != nullptr) cairo_surface_destroy(surface);
  }
};

Canvas::Canvas(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;

Result<Canvas> Canvas::create(int width_px, int height_px, const Rgba& background, PictureFormat format) {
  if (width_px < 1 || height_px < 1 || width_px > kMaxSide_px || height_px > kMaxSide_px) {
    return fail(ErrorCode::usage, kWhat, "", fmt::format("{} × {} pixels", width_px, height_px),
                fmt::format("ask for 1 to {} pixels a side", kMaxSide_px));
  }
  auto impl = std::make_unique<Impl>();
  impl->width = width_px;
  impl->height = height_px;
  impl->format = format;
  if (format == PictureFormat::svg) {
    impl->surface = cairo_svg_surface_create_for_stream(append_bytes, &impl->svg, width_px, height_px);
    if (cairo_surface_status(impl->surface) == CAIRO_STATUS_SUCCESS)
      cairo_svg_surface_set_document_unit(impl->surface, CAIRO_SVG_UNIT_PX);
  } else {
    impl->surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width_px, height_px);
  }
  impl->cairo = cairo_create(impl->surface);
  const cairo_status_t status = cairo_status(impl->cairo);
  if (status != CAIRO_STATUS_SUCCESS) return fail(code_of(status), kWhat, "", cairo_status_to_string(status));
  set_color(impl->cairo, background);
  cairo_paint(impl->cairo);
  cairo_set_line_join(impl->cairo, CAIRO_LINE_JOIN_ROUND);
  return Canvas(std::move(impl));
}

int Canvas::width_px() const { return impl_->width; }
int Canvas::height_px() const { return impl_->height; }

void Canvas::polyline(std::span<const Eigen::Vector2d> points, const StrokeStyle& style, bool closed) {
  cairo_t* cairo = impl_->cairo;
  trace(cairo, points, closed);
  set_color(cairo, style.color);
  cairo_set_line_width(cairo, style.width_px);
  cairo_set_line_cap(cairo, style.dash_px > 0 ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
  cairo_set_dash(cairo, &style.dash_px, style.dash_px > 0 ? 1 : 0, 0);
  cairo_stroke(cairo);
}

void Canvas::polygon(std::span<const Eigen::Vector2d> points, const Rgba& fill) {
  trace(impl_->cairo, points, true);
  set_color(impl_->cairo, fill);
  cairo_fill(impl_->cairo);
}

void Canvas::rings(std::span<const std::vector<Eigen::Vector2d>> rings, const Rgba& fill) {
  cairo_t* cairo = impl_->cairo;
  cairo_new_path(cairo);
  for (const std::vector<Eigen::Vector2d>& ring : rings) {
    cairo_new_sub_path(cairo);
    for (const Eigen::Vector2d& p : ring) cairo_line_to(cairo, p.x(), p.y());
    cairo_close_path(cairo);
  }
  set_color(cairo, fill);
  cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_EVEN_ODD);
  cairo_fill(cairo);
  cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_WINDING);
}

void Canvas::rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size, const Rgba& fill) {
  cairo_new_path(impl_->cairo);
  cairo_rectangle(impl_->cairo, corner.x(), corner.y(), size.x(), size.y());
  set_color(impl_->cairo, fill);
  cairo_fill(impl_->cairo);
}

void Canvas::circle(const Eigen::Vector2d& center, double radius_px, const Rgba& fill) {
  cairo_new_path(impl_->cairo);
  cairo_arc(impl_->cairo, center.x(), center.y(), radius_px, 0, 2 * M_PI);
  set_color(impl_->cairo, fill);
  cairo_fill(impl_->cairo);
}

void Canvas::text(const Eigen::Vector2d& position, std::string_view text, const TextStyle& style) {
  cairo_t* cairo = impl_->cairo;
  const std::string clean = clean_text(text);
  set_font(cairo, style);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, clean.c_str(), &extents);
  // Height of a capital letter in DejaVu Sans; the extents of the string itself would make labels dance.
  const double cap_height = 0.729 * style.size_px;
  const auto shift = [](Align align, double length) {
    return align == Align::start ? 0.0 : (align == Align::middle ? length / 2 : length);
  };
  cairo_save(cairo);
  cairo_translate(cairo, position.x(), position.y());
  cairo_rotate(cairo, -style.rotation_rad);
  cairo_move_to(cairo, -shift(style.horizontal, extents.x_advance), cap_height - shift(style.vertical, cap_height));
  if (style.halo_px > 0) {
    cairo_text_path(cairo, clean.c_str());
    set_color(cairo, {255, 255, 255, 225});
    cairo_set_dash(cairo, nullptr, 0, 0);
    cairo_set_line_width(cairo, 2 * style.halo_px);
    cairo_stroke_preserve(cairo);
    set_color(cairo, style.color);
    cairo_fill(cairo);
  } else {
    set_color(cairo, style.color);
    cairo_show_text(cairo, clean.c_str());
  }
  cairo_restore(cairo);
}

double Canvas::text_width_px(std::string_view text, const TextStyle& style) const {
  set_font(impl_->cairo, style);
  cairo_text_extents_t extents;
  cairo_text_extents(impl_->cairo, clean_text(text).c_str(), &extents);
  return extents.x_advance;
}

void Canvas::hatch(const Eigen::Vector2d& corner, const Eigen::Vector2d& size) {
  rectangle(corner, size, {243, 243, 243, 255});
  clip(corner, size);
  constexpr double kSpacingPx = 9;
  const StrokeStyle line{{218, 218, 218, 255}, 1.2, 0};
  // Anchored to the picture, not to the corner, so that neighbouring areas join.
  const double top = corner.y(), bottom = corner.y() + size.y();
  double sum = std::floor((corner.x() + corner.y()) / kSpacingPx) * kSpacingPx;
  while (sum < corner.sum() + size.sum()) {
    polyline(std::vector<Eigen::Vector2d>{{sum - top, top}, {sum - bottom, bottom}}, line);
    sum += kSpacingPx;
  }
  unclip();
}

void Canvas::image(int x_px, int y_px, int width, int height, std::span<const Rgba> pixels) {
  if (width < 1 || height < 1 || pixels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    return;
  }
  cairo_surface_t* layer = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height);
  if (cairo_surface_status(layer) == CAIRO_STATUS_SUCCESS) {
    cairo_surface_flush(layer);
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(layer));
    unsigned char* bytes = cairo_image_surface_get_data(layer);
    for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
      for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
        const std::uint32_t word = premultiplied(pixels[y * static_cast<std::size_t>(width) + x]);
        std::memcpy(bytes + y * stride + 4 * x, &word, sizeof(word));
      }
    }
    cairo_surface_mark_dirty(layer);
  }
  cairo_set_source_surface(impl_->cairo, layer, x_px, y_px);  // a failed surface puts the canvas into its error state
  cairo_paint(impl_->cairo);
  cairo_surface_destroy(layer);
}

void Canvas::clip(const Eigen::Vector2d& corner, const Eigen::Vector2d& size) {
  cairo_save(impl_->cairo);
  cairo_new_path(impl_->cairo);
  cairo_rectangle(impl_->cairo, corner.x(), corner.y(), size.x(), size.y());
  cairo_clip(impl_->cairo);
}

void Canvas::unclip() { cairo_restore(impl_->cairo); }

Result<std::string> Canvas::bytes() {
  cairo_status_t status = cairo_status(impl_->cairo);
  std::string png;
  if (status == CAIRO_STATUS_SUCCESS && impl_->format == PictureFormat::svg) {
    cairo_surface_finish(impl_->surface);
    status = cairo_surface_status(impl_->surface);
  } else if (status == CAIRO_STATUS_SUCCESS) {
    cairo_surface_flush(impl_->surface);
    status = cairo_surface_write_to_png_stream(impl_->surface, append_bytes, &png);
  }
  if (status != CAIRO_STATUS_SUCCESS) return fail(code_of(status), kWhat, "", cairo_status_to_string(status));
  return impl_->format == PictureFormat::svg ? renumber_surfaces(impl_->svg) : png;
}

Result<void> Canvas::write(const std::string& path) {
  RAYFIELD_ASSIGN(const std::string file, bytes());
  return write_file_atomically(path, file, "cannot write picture");
}

}  // namespace rayfield::formats
