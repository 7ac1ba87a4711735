#pragma once

#include <span>
#include <string>
#include <vector>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/core/season_products.h"
#include "rayfield/formats/picture.h"

/// chart: charts of a block's dates, and of numbers of any kind: PNG, or SVG where the path ends in .svg. Equal input
/// gives equal bytes.
namespace rayfield::formats {

/// Leaf area per metre of row of every panel, one date against the other: line of no change, least-squares trend, 95 %
/// intervals; gains, losses and panels within their errors differ in shape and colour. Of the options: width, title,
/// subtitle. Errors: usage (options, no panel was seen on both dates), resources, internal, bad_input (no such folder).
Result<void> write_scatter_chart(const DateComparison& comparison, const std::string& path,
                                 const PictureOptions& options = {});

/// Leaf area per metre of row through the season: the block, then each row of `rows`, with 95 % intervals; thin lines
/// are the row's panels. All share one scale. `values`: of these rows and of the block (row 0). Errors: usage (options,
/// no values, an invalid date), otherwise as above.
Result<void> write_season_chart(const BlockProducts& block, std::span<const SeasonValue> values,
                                std::span<const int> rows, const std::string& path, const PictureOptions& options = {});

/// A value with its standard error; what is not finite is left out.
struct ChartPoint {
  double x = 0, y = 0, standard_error = 0;
};
enum class SeriesMark {
  points,  ///< discs with bars of ± one standard error, joined by thin lines
  discs,   ///< the same without lines, for what lies in no order
  line,    ///< a dashed line alone, for theory
};
struct ChartSeries {
  std::string name;  ///< in the key; series of one name have one colour in all panels
  std::vector<ChartPoint> points;
  SeriesMark mark = SeriesMark::points;
};
struct ChartPanel {
  std::string title;
  std::vector<ChartSeries> series;
};
/// Panels beside and below each other, on one scale.
struct SeriesChart {
  std::string x_title, y_title;       ///< with units
  std::vector<double> x_ticks;        ///< at least two, ascending; the axis reaches a little beyond them
  std::vector<std::string> x_labels;  ///< one for each tick; empty: numbers
  bool logarithmic_x = false;         ///< ticks and values above 0
  std::vector<ChartPanel> panels;
};

/// Of the options: width, title, subtitle. Errors: usage (options, no panel, ticks as they must not be, no value to
/// draw), otherwise as above.
Result<void> write_series_chart(const SeriesChart& chart, const std::string& path, const PictureOptions& options = {});

}  // namespace rayfield::formats
