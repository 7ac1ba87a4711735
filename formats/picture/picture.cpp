#include "rayfield/formats/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>

#include "formats/io/guard.h"
#include "formats/picture/color.h"
#include "formats/picture/picture_elements.h"
#include "formats/picture/plan_drawing.h"
#include "formats/picture/render_grid.h"
#include "formats/picture/section_drawing.h"

namespace rayfield::formats {

using Eigen::Vector2d;
using elements::kPictureWhat;

namespace {

/// Before the start of each row.
void add_row_numbers(const BlockProducts& block, PlanOverlay& overlay) {
  for (const RowProduct& row : block.rows) {
    if (row.centreline.size() < 2) continue;
    const Vector2d start = row.centreline.front(), step = row.centreline[1] - start;
    const double length = step.norm();
    TextStyle style{19, elements::kInk, true, Align::middle, Align::middle, 0, 2.5};
    overlay.labels.push_back(
        {length > 0 ? Vector2d(start - 0.9 / length * step) : start, std::to_string(row.row_number), style});
  }
}

}  // namespace

Result<void> PictureOptions::validate() const {
  const auto bad = [](std::string_view why) { return fail(ErrorCode::usage, "bad picture options", "", why); };
  if (width_px < 400 || width_px > 8000) return bad("width_px must be 400 to 8000");
  if (max_height_px < 300 || max_height_px > 20000) return bad("max_height_px must be 300 to 20000");
  if (scale && !(std::isfinite(scale->low) && std::isfinite(scale->high) && scale->low < scale->high)) {
    return bad("the colour scale needs low < high");
  }
  return {};
}

PlanOverlay block_overlay(const BlockProducts& block) {
  constexpr Rgba kOutline{60, 60, 60, 190}, kPost{120, 72, 40, 255}, kGuessed{255, 255, 255, 255};
  PlanOverlay overlay;
  for (const PanelProduct& panel : block.panels) {
    if (panel.outline.size() >= 3) overlay.lines.push_back({panel.outline, {kOutline, 1.3, 0}, true});
  }
  bool some_detected = false, some_guessed = false;
  for (const PostProduct& p : block.posts) {
    overlay.markers.push_back({p.position, kPost, 3});
    if (!p.detected) overlay.markers.push_back({p.position, kGuessed, 1.8});
    some_detected = some_detected || p.detected;
    some_guessed = some_guessed || !p.detected;
  }
  add_row_numbers(block, overlay);
  if (!block.panels.empty()) overlay.keys.push_back({{kOutline, 1.6, 0}, "panel", {}});
  const PlanMarker seen{{0, 0}, kPost, 3}, hole{{0, 0}, kGuessed, 1.8};
  if (some_detected) overlay.keys.push_back({{}, "post", {seen}});
  if (some_guessed) overlay.keys.push_back({{}, "post, supposed", {seen, hole}});
  return overlay;
}

PlanOverlay change_overlay(const BlockProducts& block, const DateComparison& comparison) {
  // Drawn in this order, the bold ones over the faint.
  const std::array<std::tuple<ChangeVerdict, StrokeStyle, std::string>, 4> styles = {{
      {ChangeVerdict::not_seen, {{150, 150, 150, 255}, 1.3, 5}, "not seen"},
      {ChangeVerdict::none, {{60, 60, 60, 170}, 1.3, 0}, "within errors"},
      {ChangeVerdict::loss, {{122, 50, 10, 255}, 3, 0}, "panel lost"},
      {ChangeVerdict::gain, {{0, 74, 92, 255}, 3, 0}, "panel gained"},
  }};
  std::map<std::string, ChangeVerdict> verdicts;
  for (const PanelChange& panel : comparison.panels) verdicts[panel.panel_uid] = panel.verdict;
  PlanOverlay overlay;
  for (const auto& [verdict, style, meaning] : styles) {
    bool some = false;
    for (const PanelProduct& panel : block.panels) {
      if (panel.outline.size() < 3 || verdicts[panel.panel_uid] != verdict) continue;
      overlay.lines.push_back({panel.outline, style, true});
      some = true;
    }
    if (some) overlay.keys.insert(overlay.keys.begin(), {style, meaning, {}});
  }
  add_row_numbers(block, overlay);
  return overlay;
}

Result<void> write_plan_picture(const RasterProduct& raster, const PlanOverlay& overlay, const std::string& path,
                                const PictureOptions& options) {
  return guarded(kPictureWhat, path, [&]() -> Result<void> {
    RAYFIELD_CHECK(options.validate());
    const Grid2<float>& grid = raster.grid;
    const auto cells = static_cast<std::size_t>(std::max(grid.nx, 0)) * static_cast<std::size_t>(std::max(grid.ny, 0));
    if (cells == 0 || grid.values.size() != cells || !(grid.cell_m > 0)) {
      return fail(ErrorCode::internal, kPictureWhat, path, "the raster has no cells or its size is inconsistent");
    }
    const auto [low, high] = value_range(grid);
    const ColorScale scale = options.scale.value_or(product_scale(raster.name, low, high));
    return draw_plan({&raster, overlay, options, scale, {low<scale.low, high> scale.high}}, path);
  });
}

Result<void> write_plan_picture(const PlanOverlay& overlay, const std::string& path, const PictureOptions& options) {
  return guarded(kPictureWhat, path, [&]() -> Result<void> {
    RAYFIELD_CHECK(options.validate());
    return draw_plan({nullptr, overlay, options, {}, {}}, path);
  });
}

Result<void> write_section_picture(std::span<const LabelledSection> sections, const std::string& path,
                                   const PictureOptions& options) {
  return guarded(kPictureWhat, path, [&]() -> Result<void> {
    RAYFIELD_CHECK(options.validate());
    return draw_sections(sections, SectionOrder::one_after_the_other, path, options);
  });
}

Result<void> write_row_stack_picture(std::span<const LabelledSection> dates, const std::string& path,
                                     const PictureOptions& options) {
  return guarded(kPictureWhat, path, [&]() -> Result<void> {
    RAYFIELD_CHECK(options.validate());
    return draw_sections(dates, SectionOrder::stacked, path, options);
  });
}

Result<void> write_section_picture(const SectionProduct& section, const std::string& path,
                                   const PictureOptions& options) {
  const LabelledSection labelled{&section, "row " + std::to_string(section.row_number), {}};
  return write_section_picture(std::span<const LabelledSection>(&labelled, 1), path, options);
}

}  // namespace rayfield::formats
