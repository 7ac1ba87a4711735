#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/result.h"
#include "rayfield/density/ground_model.h"
#include "rayfield/density/row_layout.h"
#include "rayfield/tile/segments.h"
#include "rayfield/tile/store.h"

namespace rayfield::density {

/// Posts and trunks: upright cylinders near a row's centreline, seen as rings of hits that stand above each other.
struct PostOptions {
  double half_width_m = 0.35;                  ///< how far from the centreline, 0.15…0.6
  double cell_m = 0.02;                        ///< of the fine grid, 0.01…0.05
  double layer_m = 0.10;                       ///< height of its layers, 0.05…0.2
  double top_m = 3.0;                          ///< of the grid, 1.5…5
  double low_min_m = 0.20, low_max_m = 0.70;   ///< below the canopy, where stems stand free
  double min_contrast = 3;                     ///< density of hits on a stem to that around it, 1.5…20
  double min_post_height_m = 1.25;             ///< what ends lower is a trunk, 0.8…2
  double min_panel_m = 2.5, max_panel_m = 15;  ///< distance between posts
  double smoothing_m = 20;               ///< wavelength below which the centreline does not follow the posts, 5…100
  std::optional<double> panel_length_m;  ///< given: panels of this length from the row's start; posts do not rule
  Result<void> validate() const;
};

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
};

/// Fine counts of hits along the rows through one tile.
class StemAccumulator {
 public:
  /// `layout` and `ground` are only read, and must outlive the accumulator.
  StemAccumulator(tile::TileIndex index, double tile_size_m, const RowLayout& layout, const GroundModel& ground,
                  const PostOptions& options);
  ~StemAccumulator();
  StemAccumulator(const StemAccumulator&);
  StemAccumulator& operator=(const StemAccumulator&) = delete;
  StemAccumulator(StemAccumulator&&) noexcept;
  StemAccumulator& operator=(StemAccumulator&&) noexcept;
  void add(const tile::SegmentBatch& segments);
  void merge(const StemAccumulator& other);
  /// Stems whose axis stands in the tile, ordered by row and chainage.
  std::vector<Stem> finish() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// About 1 B × 35 × 30 × 50 per metre of row and thread (6.5 MB per tile of 25 m with nine rows).
Result<std::vector<Stem>> stems_of_tile(const tile::Store::TileReader& reader, tile::TileIndex index,
                                        double tile_size_m, const RowLayout& layout, const GroundModel& ground,
                                        const PostOptions& options, int threads);

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
