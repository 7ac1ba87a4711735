#pragma once

#include <optional>

#include "rayfield/core/option_fields.h"

/// Options of the first stages, from the tiles of a scan to the layout of the block. Meaning and valid range of every
/// option stand in visit_fields(), and in docs/options.md, which is made from it.
namespace rayfield::density {

/// The survey: what one reading of a tile's segments keeps.
struct SurveyOptions {
  double ground_cell_m = 0.25;
  double ground_bin_m = 0.02;
  int ground_bins = 48;
  double coverage_cell_m = 0.5;
  double path_step_s = 0.1;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("ground_cell_m", o.ground_cell_m, {0.05, 1},
             "Cells of the low histograms, rounded so that a tile holds a whole number; smaller = finer ground, fewer "
             "points per cell");
    v.number("ground_bin_m", o.ground_bin_m, {0.005, 0.1},
             "Height of a histogram's bin; of the order of the lidar's range noise");
    v.integer("ground_bins", o.ground_bins, {8, 200}, "Lowest occupied bins kept per cell; bounds memory");
    v.number("coverage_cell_m", o.coverage_cell_m, {0.1, 5}, "Cells of the coverage mask, rounded like ground_cell_m");
    v.number("path_step_s", o.path_step_s, {0.01, 1}, "The vehicle's position is averaged over steps of this length");
  }
  Result<void> validate() const;
};

/// Ground from the lifted lower convex hull (docs/ground.md).
struct GroundOptions {
  double curvature_per_m = 0.1;
  double halo_m = 8;
  int min_support = 3;
  double support_m = 0.10;
  double max_drop_m = 0.25;
  double max_rise_m = 0.30;
  double fit_radius_m = 0.14;
  double max_gap_m = 2.0;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("curvature_per_m", o.curvature_per_m, {0.01, 1},
             "k of the lifted height z + k(x² + y²); larger follows sharper hollows, and more noise");
    v.number("halo_m", o.halo_m, {2, 50},
             "How far around a tile its neighbours are used; enough while the relief within it is below k·halo²");
    v.integer("min_support", o.min_support, {1, 100},
              "Hits that a cell needs within support_m above its candidate; fewer = multipath");
    v.number("support_m", o.support_m, {0.02, 0.5}, "See min_support");
    v.number("max_drop_m", o.max_drop_m, {0.05, 2}, "A candidate further below all its neighbours is multipath");
    v.number("max_rise_m", o.max_rise_m, {0.05, 1}, "How far above the hull the ground may be (banks, noise)");
    v.number("fit_radius_m", o.fit_radius_m, {0.05, 1}, "Standard deviation of the weights of the local plane");
    v.number("max_gap_m", o.max_gap_m, {0.25, 20}, "Ground further than this from any supported cell is unknown");
  }
  Result<void> validate() const;
};

/// Hits in plan, by height above the ground: what rows are found in.
struct CanopyMapOptions {
  double cell_m = 0.10;
  double stem_min_m = 0.15;
  double canopy_min_m = 0.60;
  double canopy_max_m = 2.60;
  double tall_min_m = 4.50;
  double tall_max_m = 12.0;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("cell_m", o.cell_m, {0.02, 0.5}, "Cells of the map, rounded so that a tile holds a whole number");
    v.number("stem_min_m", o.stem_min_m, {0.01, 100},
             "Low end of the layer of trunks and posts, which ends at the canopy");
    v.number("canopy_min_m", o.canopy_min_m, {0.01, 100}, "Low end of the canopy's layer");
    v.number("canopy_max_m", o.canopy_max_m, {0.01, 100}, "High end of the canopy's layer");
    v.number("tall_min_m", o.tall_min_m, {0.01, 100},
             "Low end of the layer of what is taller than vines: trees, sheds");
    v.number("tall_max_m", o.tall_max_m, {0.01, 100}, "High end of that layer; the five heights ascend");
  }
  Result<void> validate() const;
};

/// How the trajectory is cut into passes along lanes.
struct PassOptions {
  double spacing_m = 0.5;
  double min_length_m = 6;
  double min_radius_m = 12;
  double max_jump_m = 3;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("spacing_m", o.spacing_m, {0.1, 2}, "Between the vertices of a pass");
    v.number("min_length_m", o.min_length_m, {3, 100}, "Shorter pieces are turns or manoeuvres");
    v.number("min_radius_m", o.min_radius_m, {5, 50},
             "Tighter bends are headland turns; rows may curve down to about five times it");
    v.number("max_jump_m", o.max_jump_m, {0.5, 20},
             "Between successive points of the trajectory; where they lie further apart it is cut");
  }
  Result<void> validate() const;
};

/// Rows are traced in the canopy beside every pass, so that they may stand in any direction and curve gently, and are
/// then verified: a lane outside of the block, a headland, a fence or a line of trees makes no row.
struct RowOptions {
  PassOptions passes;
  double min_offset_m = 0.5;
  double max_offset_m = 2.6;
  double half_width_m = 0.3;
  double max_gap_m = 6.0;
  double min_length_m = 5.0;
  double min_cover = 0.5;
  double min_strength_share = 0.25;
  double max_tall_share = 0.3;
  double max_lane_share = 0.5;
  double smoothing_m = 12.0;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.group("passes", o.passes);
    v.number("min_offset_m", o.min_offset_m, {0.2, 2}, "Nearest a row can stand to the vehicle's track");
    v.number("max_offset_m", o.max_offset_m, {1, 6}, "Furthest: half the widest lane");
    v.number("half_width_m", o.half_width_m, {0.1, 1}, "Of the core of a canopy, in which its strength is measured");
    v.number("max_gap_m", o.max_gap_m, {1, 30}, "A longer gap without canopy, post or trunk ends the row");
    v.number("min_length_m", o.min_length_m, {2, 100}, "Shorter ones are no rows");
    v.number("min_cover", o.min_cover, {0.1, 1}, "Share of the row with canopy");
    v.number("min_strength_share", o.min_strength_share, {0, 1},
             "Of the median row's strength; what is weaker is a fence or weeds");
    v.number("max_tall_share", o.max_tall_share, {0, 1}, "Share of the row under something taller than a vine");
    v.number("max_lane_share", o.max_lane_share, {0.1, 1},
             "Canopy in the lanes beside the row, as a share of that in the row");
    v.number("smoothing_m", o.smoothing_m, {2, 100}, "Wavelength below which the centreline does not follow");
  }
  Result<void> validate() const;
};

/// Posts and trunks: upright cylinders near a row's centreline, seen as rings of hits that stand above each other.
struct PostOptions {
  double half_width_m = 0.35;
  double cell_m = 0.02;
  double layer_m = 0.10;
  double top_m = 3.0;
  double low_min_m = 0.20;
  double low_max_m = 0.70;
  double min_contrast = 3;
  double min_post_height_m = 1.25;
  double min_panel_m = 2.5;
  double max_panel_m = 15;
  double smoothing_m = 20;
  std::optional<double> panel_length_m;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("half_width_m", o.half_width_m, {0.15, 0.6}, "How far from the centreline they are looked for");
    v.number("cell_m", o.cell_m, {0.01, 0.05}, "Cells in plan of the fine grid of hits");
    v.number("layer_m", o.layer_m, {0.05, 0.2}, "Height of the grid's layers");
    v.number("top_m", o.top_m, {1.5, 5}, "Of the grid");
    v.number("low_min_m", o.low_min_m, {0.05, 1}, "From here to low_max_m, below the canopy, stems stand free");
    v.number("low_max_m", o.low_max_m, {0.15, 1.5}, "At least two layers above low_min_m");
    v.number("min_contrast", o.min_contrast, {1.5, 20}, "Density of hits on a stem to that around it");
    v.number("min_post_height_m", o.min_post_height_m, {0.8, 2}, "What ends lower is a trunk");
    v.number("min_panel_m", o.min_panel_m, {1, 20}, "Least distance between posts");
    v.number("max_panel_m", o.max_panel_m, {1, 50}, "Largest distance between posts, at least min_panel_m");
    v.number("smoothing_m", o.smoothing_m, {5, 100}, "Wavelength below which the centreline does not follow the posts");
    v.optional_number("panel_length_m", o.panel_length_m, {0.5, 1000},
                      "If given, panels of this length from the row's start instead of panels between posts");
  }
  Result<void> validate() const;
};

/// How the registry learns from later scans (docs/registry.md).
struct RegistryOptions {
  double known_within_m = 0.15;
  double same_post_m = 0.25;
  double same_place_m = 0.05;
  int present_dates = 2;
  int absent_dates = 2;
  double min_seen_share = 0.8;
  double min_driven_share = 0.5;
  int min_row_stems = 3;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("known_within_m", o.known_within_m, {0.02, 0.5},
             "A stem this close to a known post or trunk is that one, seen again");
    v.number("same_post_m", o.same_post_m, {0.05, 1},
             "A post this close to one that was placed by spacing or survey is that one, seen for the first time");
    v.number("same_place_m", o.same_place_m, {0.01, 0.2},
             "An unknown post of several dates has to stand in one place to within this");
    v.integer("present_dates", o.present_dates, {1, 20}, "Dates on which an unknown post has to be seen to be one");
    v.integer("absent_dates", o.absent_dates, {2, 20},
              "Dates in a row on which a well observed post or row has to be missing to be gone");
    v.number("min_seen_share", o.min_seen_share, {0.5, 1},
             "Of a post's neighbours that a scan has to show for the post's own place to count as well observed");
    v.number("min_driven_share", o.min_driven_share, {0.1, 1},
             "Of a row's length that has to be driven along for the row to be missed");
    v.integer("min_row_stems", o.min_row_stems, {1, 100}, "Posts and trunks that a new row has to show");
  }
  Result<void> validate() const;
};

}  // namespace rayfield::density
