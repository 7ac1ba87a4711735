#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/core/season_products.h"
#include "rayfield/core/zone_products.h"
#include "rayfield/formats/style.h"

/// Maps, plans and vertical sections as PNG, or as SVG where the path ends in .svg, without a display. NaN is hatched
/// grey ("not scanned"), zero is light.
namespace rayfield::formats {

struct PictureOptions {
  /// Width of the picture, 400 … 8000 px. Type and lines grow with it.
  int width_px = 1600;
  /// The map is drawn smaller where the picture would become higher than this, 300 … 20000 px.
  int max_height_px = 1500;
  std::string title, subtitle;
  /// Default: the fixed scale of the product (docs/products.md).
  std::optional<ColorScale> scale;
  /// Heading of the colour bar; default: a name made from the product and its unit.
  std::string legend;
  /// Plan views: cut off margins that were not scanned and hold no overlay.
  bool crop_to_data = true;
  /// Plan views: eastings and northings along the frame.
  bool coordinates = true;

  Result<void> validate() const;
};

/// Things drawn over a map, or alone as a plan. Map coordinates, m.
struct PlanLine {
  std::vector<Eigen::Vector2d> points;
  StrokeStyle style;
  bool closed = false;
};
struct PlanMarker {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  Rgba color{120, 80, 50, 255};
  double radius_px = 3;
};
struct PlanLabel {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  std::string text;
  TextStyle style;
};
struct PlanKey {  ///< an entry of the legend: a short line in this style (or markers, or a box), and its meaning
  StrokeStyle style;
  std::string text;
  std::vector<PlanMarker> markers;  ///< if any: these on top of each other instead of the line
  std::optional<Rgba> fill = {};    ///< a box of this colour with the line around it
};
/// The number of a thing in a series, drawn beside it. Without room for all, only every second, fifth, tenth … is
/// shown; none if the lane is too narrow for type.
struct PlanNumber {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< on the thing's border
  Eigen::Vector2d aside = Eigen::Vector2d::UnitY();    ///< unit vector away from it
  int number = 0;
  double along_m = 0, across_m = 0;  ///< room along the row, and beside it
};
/// A shaded area: the points inside an odd number of its rings.
struct PlanArea {
  std::vector<std::vector<Eigen::Vector2d>> rings;
  Rgba fill;
  StrokeStyle outline;
};
struct PlanOverlay {
  std::vector<PlanArea> areas;  ///< below all others
  std::vector<PlanLine> lines;
  std::vector<PlanMarker> markers;
  std::vector<PlanLabel> labels;
  std::vector<PlanKey> keys;
  std::vector<PlanNumber> numbers = {};
};

/// Panel outlines, posts (hollow where not detected), row and panel numbers of a block.
PlanOverlay block_overlay(const BlockProducts& block);

/// Management zones shaded, with their means in the key, and the numbers of rows; `unit`: of the means ("m2/m").
PlanOverlay zone_overlay(const BlockProducts& block, std::span<const ManagementZone> zones, const std::string& unit);

/// The same on a map of changes: panels that gained or lost are outlined boldly, the others faintly.
PlanOverlay change_overlay(const BlockProducts& block, const DateComparison& comparison);

/// A raster with colour bar, scale bar, north arrow, title, and what lies over it. Cells are averaged by area where the
/// picture is coarser than the raster (cells without a value left out). Errors: usage (options), bad_input (no such
/// folder), resources, internal.
Result<void> write_plan_picture(const RasterProduct& raster, const PlanOverlay& overlay, const std::string& path,
                                const PictureOptions& options = {});

/// A plan without a raster, e.g. of a trajectory; nothing to draw gives an error (usage).
Result<void> write_plan_picture(const PlanOverlay& overlay, const std::string& path,
                                const PictureOptions& options = {});

/// A section and what to write before it ("row 3", "2019-02-11").
struct LabelledSection {
  const SectionProduct* section = nullptr;
  std::string label;
  std::vector<double> marks_m;  ///< thin vertical lines at these distances along the section, e.g. posts
};

/// Vertical sections under each other on one scale, in the same proportions (no exaggeration), axes in metres. Sections
/// too long for the width are continued on further lines. Errors: as write_plan_picture().
Result<void> write_section_picture(std::span<const LabelledSection> sections, const std::string& path,
                                   const PictureOptions& options = {});
Result<void> write_section_picture(const SectionProduct& section, const std::string& path,
                                   const PictureOptions& options = {});

/// End-on sections of rows beside and below each other, all in one window of the plane across the row, as large as the
/// sheet takes: the picture has the width asked for or less, and the height that it needs. Errors: as
/// write_plan_picture().
Result<void> write_end_on_picture(std::span<const LabelledSection> rows, const std::string& path,
                                  const PictureOptions& options = {});

/// One row's side views on several dates under each other: the same stretch of row on all of them, one scale. What a
/// date did not see is hatched. Errors: as write_plan_picture().
Result<void> write_row_stack_picture(std::span<const LabelledSection> dates, const std::string& path,
                                     const PictureOptions& options = {});

}  // namespace rayfield::formats
