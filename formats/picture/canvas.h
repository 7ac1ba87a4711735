#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "rayfield/core/result.h"
#include "rayfield/formats/style.h"

namespace rayfield::formats {

/// A picture in memory, drawn without a display and written as PNG. Pixel coordinates: x right, y down, pixel (0,0)
/// covers [0,1)². Equal calls give equal bytes with equal fonts (DejaVu Sans, package fonts-dejavu-core; without it
/// another font stands in). Text that is not UTF-8 is repaired.
class Canvas {
 public:
  /// Width and height 1 … 20000 px. Errors: usage, resources (memory).
  static Result<Canvas> create(int width_px, int height_px, const Rgba& background = {255, 255, 255, 255});
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;
  ~Canvas();

  int width_px() const;
  int height_px() const;

  void polyline(std::span<const Eigen::Vector2d> points, const StrokeStyle& style, bool closed = false);
  void polygon(std::span<const Eigen::Vector2d> points, const Rgba& fill);
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

  /// The PNG's bytes. Errors: resources, internal (a drawing call failed).
  Result<std::string> png() const;
  /// Writes them; the file appears whole or not at all. Errors: as png(), and bad_input (no such folder).
  Result<void> write_png(const std::string& path) const;

 private:
  struct Impl;
  explicit Canvas(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayfield::formats
