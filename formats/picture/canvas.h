#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/formats/style.h"

namespace rayfield::formats {

/// What a canvas is written as.
enum class PictureFormat { png, svg };
/// By the ending of a path: ".svg", in whatever case, or else PNG.
PictureFormat format_of(std::string_view path);

/// A picture in memory, drawn without a display and written as PNG or SVG. Pixel coordinates: x right, y down, pixel
/// (0,0) covers [0,1)². Equal calls give equal bytes with equal fonts (DejaVu Sans, package fonts-dejavu-core; without
/// it another font stands in; in an SVG letters are outlines). Text that is not UTF-8 is repaired.
class Canvas {
 public:
  /// Width and height 1 … 20000 px. Errors: usage, resources (memory).
  static Result<Canvas> create(int width_px, int height_px, const Rgba& background = {255, 255, 255, 255},
                               PictureFormat format = PictureFormat::png);
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;
  ~Canvas();

  int width_px() const;
  int height_px() const;

  void polyline(std::span<const Eigen::Vector2d> points, const StrokeStyle& style, bool closed = false);
  void polygon(std::span<const Eigen::Vector2d> points, const Rgba& fill);
  /// What lies inside an odd number of the rings.
  void rings(std::span<const std::vector<Eigen::Vector2d>> rings, const Rgba& fill);
  void rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size, const Rgba& fill);
  void circle(const Eigen::Vector2d& center, double radius_px, const Rgba& fill);
  void text(const Eigen::Vector2d& position, std::string_view text, const TextStyle& style = {});
  double text_width_px(std::string_view text, const TextStyle& style = {}) const;
  /// Diagonal grey lines: the sign for "not scanned".
  void hatch(const Eigen::Vector2d& corner, const Eigen::Vector2d& size);
  /// An image of width · height pixels, first row on top, unscaled at a whole pixel. Transparent where alpha is 0.
  void image(int x_px, int y_px, int width, int height, std::span<const Rgba> pixels);
  /// Everything until unclip() stays inside the rectangle.
  void clip(const Eigen::Vector2d& corner, const Eigen::Vector2d& size);
  void unclip();

  /// Ends the drawing and gives the file's bytes. Errors: resources, internal (a drawing call failed).
  Result<std::string> bytes();
  /// Writes them; the file appears whole or not at all. Errors: as bytes(), and bad_input (no such folder).
  Result<void> write(const std::string& path);

 private:
  struct Impl;
  explicit Canvas(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayfield::formats
