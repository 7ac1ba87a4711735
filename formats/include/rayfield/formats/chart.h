#pragma once

#include <span>
#include <string>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/core/season_products.h"
#include "rayfield/formats/picture.h"

/// Charts of a block's dates: PNG, or SVG where the path ends in .svg. Equal input gives equal bytes.
namespace rayfield::formats {

/// Leaf area per metre of row of every panel, one date against the other: line of no change, least-squares trend, 95 %
/// intervals; gains, losses and panels within their errors differ in shape and colour. Of the options: width, title,
/// subtitle. Errors: usage (options, no panel was seen on both dates), resources, internal, bad_input (no such folder).
Result<void> write_scatter_chart(const DateComparison& comparison, const std::string& path,
                                 const PictureOptions& options = {});

/// Leaf area per metre of row through the season: the block, then each row of `rows`, with 95 % intervals; thin lines
/// are the row's panels. All on one scale. `values`: of these rows and of the block (row 0). Errors: usage (options, no
/// values, a date that is none), otherwise as above.
Result<void> write_season_chart(const BlockProducts& block, std::span<const SeasonValue> values,
                                std::span<const int> rows, const std::string& path, const PictureOptions& options = {});

}  // namespace rayfield::formats
