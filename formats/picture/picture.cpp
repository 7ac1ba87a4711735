#include "rayfield/formats/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <tuple>

#include "formats/io/guard.h"
#include "formats/picture/color.h"
#include "formats/picture/end_on_drawing.h"
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

/// Where a centreline is at a chainage, and its direction there.
std::pair<Vector2d, Vector2d> place_at(const std::vector<Vector2d>& line, double chainage_m) {
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vector2d step = line[i] - line[i - 1];
    const double length = step.norm();
    if (length > 0 && (chainage_m <= length || i + 1 == line.size()))
      return {line[i - 1] + chainage_m / length * step, step / length};
    chainage_m -= length;
  }
  return {line.front(), Vector2d::UnitX()};
}

/// Beside every panel, to the left of its row. The last row on that side has nothing beside it.
void add_panel_numbers(const BlockProducts& block, PlanOverlay& overlay) {
  std::map<int, const RowProduct*> rows;
  for (const RowProduct& row : block.rows)
    if (row.centreline.size() >= 2) rows[row.row_number] = &row;
  for (const PanelProduct& panel : block.panels) {
    const auto found = rows.find(panel.row_number);
    if (found == rows.end() || panel.outline.size() < 3) continue;
    const RowProduct& row = *found->second;
    const auto [middle, along] = place_at(row.centreline, (panel.chainage_start_m + panel.chainage_end_m) / 2);
    const Vector2d left(-along.y(), along.x());
    double half_m = 0;
    for (const Vector2d& p : panel.outline) half_m = std::max(half_m, std::abs((p - middle).dot(left)));
    bool free = true;  // no other row on the left
    for (const auto& [number, other] : rows)
      free = free && (number == row.row_number || (other->centreline.front() - row.centreline.front()).dot(left) <= 0);
    const double lane_m = free || !std::isfinite(row.spacing_m) ? 1e3 : row.spacing_m - 2 * half_m;
    overlay.numbers.push_back({middle + half_m * left, left, panel.panel_number, panel.length_m, lane_m});
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
  add_panel_numbers(block, overlay);
  if (!block.panels.empty()) overlay.keys.push_back({{kOutline, 1.6, 0}, "panel", {}});
  const PlanMarker seen{{0, 0}, kPost, 3}, hole{{0, 0}, kGuessed, 1.8};
  if (some_detected) overlay.keys.push_back({{}, "post", {seen}});
  if (some_guessed) overlay.keys.push_back({{}, "post, supposed", {seen, hole}});
  return overlay;
}

PlanOverlay zone_overlay(const BlockProducts& block, std::span<const ManagementZone> zones, const std::string& unit) {
  PlanOverlay overlay;
  const std::span<const Rgba> stops = ramp_stops(Ramp::uncertainty);  // unlike the colours of the map below
  for (const ManagementZone& zone : zones) {
    // Low zones are light, high ones dark.
    const double share = zones.size() > 1 ? (zone.zone - 1.0) / static_cast<double>(zones.size() - 1) : 0.5;
    Rgba tint = stops[static_cast<std::size_t>(2 + std::lround(share * static_cast<double>(stops.size() - 4)))];
    const StrokeStyle outline{tint, 2.2, 0};
    tint.a = 95;
    for (const ZonePart& part : zone.parts) {
      PlanArea area{{part.exterior}, tint, outline};
      area.rings.insert(area.rings.end(), part.holes.begin(), part.holes.end());
      overlay.areas.push_back(std::move(area));
    }
    overlay.keys.push_back(
        {outline, fmt::format("zone {}: {:.1f} {}", zone.zone, zone.mean, pretty_unit(unit)), {}, tint});
  }
  add_row_numbers(block, overlay);
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

Result<void> write_end_on_picture(std::span<const LabelledSection> rows, const std::string& path,
                                  const PictureOptions& options) {
  return guarded(kPictureWhat, path, [&]() -> Result<void> {
    RAYFIELD_CHECK(options.validate());
    return draw_end_on(rows, path, options);
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
