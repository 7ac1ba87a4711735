#pragma once
/// posts: upright things in the rows: posts, trunks, and the panels between posts.
#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libdensity/ground/ground_model.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/core/result.h"
#include "rayfield/density/layout_options.h"

namespace rayfield::density {

/// An upright thing in a row.
struct Stem {
  int row = 0;                                         ///< Row::number
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of the axis at the ground, m
  Eigen::Vector2d lean = Eigen::Vector2d::Zero();      ///< horizontal shift per metre of height
  double radius_m = 0;
  double top_m = 0;        ///< above the ground; up to here it is one column
  double contrast = 0;     ///< density of hits on it to around it, below the canopy
  double upper_share = 0;  ///< hits on it above min_post_height_m, where they stand out, relative to below the canopy
  double solidity = 0;     ///< log-likelihood ratio of a solid post against leaves in the canopy, > 0 = post
  bool operator==(const Stem&) const = default;
};

/// A stem with its place in its row.
struct PlacedStem {
  Stem stem;
  double chainage_m = 0, across_m = 0;
};

/// The stems of one row along its centreline, each once (neighbouring tiles both see one on their border).
std::vector<PlacedStem> stems_of_row(const Row& row, std::span<const Stem> stems);

struct PostReport {
  double panel_length_m = 0;  ///< usual distance of posts; NaN if not found
  int detected = 0, inferred = 0, trunks = 0;
  std::vector<std::string> warnings;
};

/// Posts, trunks and panels from the stems of all tiles. Refines the rows of `layout`: centrelines through the posts,
/// ends at the outermost posts; chainages are counted from the new starts. Posts that the regular spacing wants but
/// that were not seen have detected = false. A row without posts keeps its traced ends and is one panel.
Result<PostReport> place_posts(RowLayout& layout, std::span<const Stem> stems, const PostOptions& options);

/// Panels between posts, or of `panel_length_m` from each row's start (a last one shorter than half joins its
/// neighbour). Replaces layout.panels.
void make_panels(RowLayout& layout, std::optional<double> panel_length_m);

}  // namespace rayfield::density
