#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rayfield/density/layout_options.h"

/// options: all options of the processing from tiles to maps, those of voxels and density here, those of ground and
/// layout in layout_options.h. Meaning and valid range of every option stand in visit_fields(), and in docs/options.md,
/// which is made from it.
namespace rayfield::density {

/// The voxel grids of a scan: extents per row from the canopy's end points (paper, appendix Voxelisation), cut into
/// straight row segments that follow the centreline and the ground.
struct RowSegmentOptions {
  double voxel_m = 0.08;
  int voxels_per_segment = 38;
  double up_min_m = 0.30;
  double across_low = 0.02;
  double across_high = 0.98;
  double up_high = 0.97;
  int widen_voxels = 2;
  double min_half_width_m = 0.24;
  double min_height_m = 0.60;
  double max_height_m = 4.0;
  double lone_half_width_m = 1.5;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("voxel_m", o.voxel_m, {0.03, 0.3},
             "Side of a voxel unless it is fitted to the leaves; see docs/density.md, \"Voxel size\"; the paper has "
             "0.12");
    v.integer("voxels_per_segment", o.voxels_per_segment, {4, 200},
              "Voxels along a row segment (38 of 0.08 m are 3.04 m); fewer follow curves and relief more closely");
    v.number("up_min_m", o.up_min_m, {0, 1.5}, "Low face of the grid above the ground");
    v.number("across_low", o.across_low, {0, 0.4}, "Quantile of end points across the row, right face");
    v.number("across_high", o.across_high, {0.6, 1}, "Quantile of end points across the row, left face");
    v.number("up_high", o.up_high, {0.6, 1}, "Quantile of end points upwards, top face");
    v.integer("widen_voxels", o.widen_voxels, {0, 10},
              "Voxels added beyond the quantiles on both sides and on top. The quantiles cut outliers and leaves "
              "alike: they leave 4 % of the hits outside across and 3 % above. Empty voxels add nothing to a sum, so "
              "a voxel more costs memory and time only (docs/rows.md)");
    v.number("min_half_width_m", o.min_half_width_m, {0.05, 2}, "Least half width of the grid");
    v.number("min_height_m", o.min_height_m, {0.1, 3}, "Least height of the grid above its low face");
    v.number("max_height_m", o.max_height_m, {0.1, 8},
             "Hits higher above the ground are no canopy; at least up_min_m + min_height_m");
    v.number("lone_half_width_m", o.lone_half_width_m, {0.3, 3},
             "How far a canopy may reach where there is no neighbouring row");
  }
  Result<void> validate() const;
};

/// The same options with voxels of another size and row segments of about the same length.
RowSegmentOptions with_voxel_size(const RowSegmentOptions& options, double voxel_m);

/// Voxels fitted to the leaves (docs/density.md, "Voxel size"): leaves that reach out of a small voxel shade it, and
/// uneven density inside a large one is underestimated. The side is `leaf_sides` times that of a square as large as the
/// leaves look, in whole millimetres.
struct VoxelFitOptions {
  bool enabled = true;
  double leaf_sides = 0.85;
  double min_m = 0.06;
  double max_m = 0.12;
  double sample_m = 0.08;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.flag("enabled", o.enabled, "false: the voxel size of the row segments rules");
    v.number("leaf_sides", o.leaf_sides, {0.5, 5},
             "Side of a voxel in sides of a leaf; larger underestimates clumped canopies, smaller overestimates large "
             "leaves");
    v.number("min_m", o.min_m, {0.03, 0.3}, "Smallest voxel");
    v.number("max_m", o.max_m, {0.03, 0.3}, "Largest voxel, at least min_m; the paper's size");
    v.number("sample_m", o.sample_m, {0.03, 0.3},
             "Side of the voxels that tell the hits on leaves when their size is measured beforehand");
  }
  Result<void> validate() const;
};

/// Distributions of leaf inclination (angle between a leaf's normal and the vertical; azimuths uniform).
/// de Wit's types plus Campbell's ellipsoid.
/// `measured`: from each scan, spherical until then.
enum class LeafAngleType {
  spherical,
  uniform,
  planophile,
  erectophile,
  plagiophile,
  extremophile,
  ellipsoidal,
  measured
};
inline constexpr OptionChoices<LeafAngleType, 8> kLeafAngleTypes{{{"spherical", LeafAngleType::spherical},
                                                                  {"uniform", LeafAngleType::uniform},
                                                                  {"planophile", LeafAngleType::planophile},
                                                                  {"erectophile", LeafAngleType::erectophile},
                                                                  {"plagiophile", LeafAngleType::plagiophile},
                                                                  {"extremophile", LeafAngleType::extremophile},
                                                                  {"ellipsoidal", LeafAngleType::ellipsoidal},
                                                                  {"measured", LeafAngleType::measured}}};
/// "spherical", "planophile" … Errors: usage.
Result<LeafAngleType> parse_leaf_angle_type(std::string_view name);

struct LeafAngles {
  LeafAngleType type = LeafAngleType::measured;
  double ellipsoid_ratio = 1.0;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.choice(
        "type", o.type, kLeafAngleTypes,
        "Distribution of the leaves' inclination; azimuths are uniform. measured: spherical, unless the "
        "directions of a "
        "scan's hits, and of wide beams the normals of full echoes, say that its leaves are clearly flatter, which "
        "counts as ellipsoidal then");
    v.number("ellipsoid_ratio", o.ellipsoid_ratio, {0.05, 20},
             "Of ellipsoidal ones, horizontal over vertical semi-axis; 1 = spherical, above 1 = flatter leaves");
  }
  Result<void> validate() const;
};

/// Correction for the width of beams that are not thin, where the rig states it (docs/beams.md).
struct BeamOptions {
  bool enabled = true;
  double range_resolution_m = 0;
  double full_echo = 0;
  double widest_m = 0.08;
  double farthest_m = 6;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.flag("enabled", o.enabled, "false: every echo counts as the hit of a thin ray, whatever the beam");
    v.number(
        "range_resolution_m", o.range_resolution_m, {0, 2},
        "What lies closer together along the beam makes one echo: half the length of the pulse; 0 = as the rig says "
        "or as SLAM, the leaves or the ground tell, else 0.15");
    v.number("full_echo", o.full_echo, {0, 65535},
             "Mean intensity of the echo of leaves that take the whole beam; 0 = measured from the scan");
    v.number("widest_m", o.widest_m, {0.02, 10},
             "Beams that are not thin are followed up to where they get this wide, and at least 4 m: no leaf holds a "
             "wider one");
    v.number("farthest_m", o.farthest_m, {4, 1000},
             "Nor are they followed farther than this: what is seen from far along the row, or through the row before "
             "it, has come through too many leaves, m");
  }
  Result<void> validate() const;
};

/// Counting rays in voxels.
struct VoxelOptions {
  LeafAngles leaf_angles;
  double wood_shell_m = 0.045;
  double sure_return_m = 30;
  double slope_margin = 0.02;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.group("leaf_angles", o.leaf_angles);
    v.number("wood_shell_m", o.wood_shell_m, {0, 0.2},
             "Widening of known wood: range noise spreads hits on a post about its surface. Three standard deviations "
             "of it lose 0.1 % of them; what is masked in vain only lowers the ray count");
    v.number("sure_return_m", o.sure_return_m, {0, 200},
             "Clouds lack the downward rays that came back from nowhere, so a ray that runs down at a small angle is "
             "there if a leaf stopped it and missing if not. Rays that go down and would not meet the ground of the "
             "tile (a plane) within this distance of where they enter the tile are therefore left out, whatever they "
             "met. Shorter costs the view of the canopy at the sensor's height; longer than the range from which bare "
             "ground returns is in vain. 0 = count all, as is done where a scan holds such rays");
    v.number("slope_margin", o.slope_margin, {0, 0.5},
             "How much more than that plane the ground may fall away, as a slope");
  }
  Result<void> validate() const;
};

enum class Estimator {
  unbiased,  ///< λ̂ = m/S − H/S² over slabs of nine voxels, finite leaves corrected
  paper      ///< (n−1)/n·m/S with neighbours borrowed until n ≥ 10: the published method
};
inline constexpr OptionChoices<Estimator, 2> kEstimators{
    {{"unbiased", Estimator::unbiased}, {"paper", Estimator::paper}}};
/// "unbiased", "paper". Errors: usage.
Result<Estimator> parse_estimator(std::string_view name);

/// From counts to leaf area density.
struct EstimatorOptions {
  Estimator estimator = Estimator::unbiased;
  double leaf_size_m2 = -1;
  int paper_min_rays = 10;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.choice("estimator", o.estimator, kEstimators, "unbiased, or the published method");
    v.number("leaf_size_m2", o.leaf_size_m2, {-kUnbounded, 0.05},
             "Area of one leaf; 0 = infinitesimal leaves, negative = measured from the scan. A third too large lowers "
             "the density of a typical canopy by 1 %, by 2 % with voxels fitted to it");
    v.integer("paper_min_rays", o.paper_min_rays, {1, 1000},
              "The published method borrows neighbours until a voxel has that many rays");
  }
  Result<void> validate() const;
};

/// From the densities of a row to panels, half metres and sections.
struct IntegrationOptions {
  double height_share = 0.97;
  double width_share = 0.96;
  double min_observed_fraction = 0.5;
  double shared_error = 0.025;
  double metre_step_m = 0.5;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("height_share", o.height_share, {0.5, 1},
             "The canopy's height is where this share of its area lies below (the paper's 97th percentile)");
    v.number("width_share", o.width_share, {0.5, 1},
             "The canopy's width holds this share of its area (the paper's 2nd to 98th percentile)");
    v.number("min_observed_fraction", o.min_observed_fraction, {0, 1}, "Panels of which less was seen have no values");
    v.number("shared_error", o.shared_error, {0, 1},
             "Relative standard error that all voxels of a panel share (leaf angles, clumping below the voxel size), "
             "in the intervals only; the default is the spread of the ratio to truth over simulated canopies of "
             "different kinds");
    v.number("metre_step_m", o.metre_step_m, {0.01, 100}, "Length of row of one value in the table of row metres");
  }
  Result<void> validate() const;
};

/// What growers ask of a canopy (docs/descriptors.md). Its edges are those of IntegrationOptions::height_share and
/// width_share.
struct DescriptorOptions {
  double fruit_zone_low_m = 0.8;
  double fruit_zone_high_m = 1.2;
  double gap_area_share = 0.2;
  double profile_band_m = 0.25;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("fruit_zone_low_m", o.fruit_zone_low_m, {0, 10},
             "Lower end of the fruit zone above the ground. The zone is the farm's to name; the default is that of "
             "shoots that are trained upwards from a wire at 0.8 or 0.9 m");
    v.number("fruit_zone_high_m", o.fruit_zone_high_m, {0, 10}, "Its upper end, above fruit_zone_low_m");
    v.number("gap_area_share", o.gap_area_share, {0, 1},
             "A half metre of row is a gap where it has less than this share of the canopy area of the upper quartile "
             "of its row's half metres");
    v.number("profile_band_m", o.profile_band_m, {0.05, 5}, "Height of a band of the vertical profile");
  }
  Result<void> validate() const;
};

/// Leaf areas, where a dormant scan shows the wood (docs/density.md, "Leaf area").
struct LeafOptions {
  double wood_error = 0.05;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("wood_error", o.wood_error, {0, 1},
             "Relative standard error of the wood that a dormant scan shows and a leafy one hides, in the intervals "
             "only: what both see alike cancels in their difference");
  }
  Result<void> validate() const;
};

/// Cordons, canes, branches and wires where no dormant scan shows them (docs/density.md, "Without a dormant scan").
struct WoodPriorOptions {
  bool enabled = true;
  double per_side = 0.18;
  double spread = 1.8;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.flag("enabled", o.enabled, "false: without a dormant scan leaf areas hold all wood but posts and trunks");
    v.number("per_side", o.per_side, {0.001, 5},
             "Half the surface of that wood, m² per m² of the canopy's side: what vines and orchards have in the "
             "middle; plant areas of beams that are not thin use it, too");
    v.number("spread", o.spread, {1.01, 10},
             "Two of three vineyards and orchards have between this times less and this times more");
  }
  Result<void> validate() const;
};

/// Maps.
struct PlanRasterOptions {
  double cell_m = 0.10;
  double height_share = 0.97;

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.number("cell_m", o.cell_m, {0.01, 10}, "Cells, aligned to multiples of it in map coordinates");
    v.number("height_share", o.height_share, {0.5, 1}, "As of integration, here for each voxel column");
  }
  Result<void> validate() const;
};

/// Everything that can be set about the way from tiles to maps. What comes after the groups says what to do now and
/// changes no result.
struct ProcessOptions {
  SurveyOptions survey;
  GroundOptions ground;
  CanopyMapOptions canopy;
  RowOptions rows;
  PostOptions posts;
  RegistryOptions registry;
  RowSegmentOptions segments;
  VoxelFitOptions voxel_fit;
  VoxelOptions voxels;
  BeamOptions beam;
  EstimatorOptions estimator;
  IntegrationOptions integration;
  PlanRasterOptions plan;
  LeafOptions leaf;
  DescriptorOptions descriptors;
  WoodPriorOptions wood;

  std::vector<std::string> dates;                       ///< scan ids or dates to process; empty = all
  bool redo = false;                                    ///< make everything anew; for all scans, the layout too
  int threads = 0;                                      ///< 0 = all processors
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;  ///< bound on resident memory; see process_memory.h

  template <class Self, class Visitor>
  static void visit_fields(Self& o, Visitor& v) {
    v.group("survey", o.survey);
    v.group("ground", o.ground);
    v.group("canopy", o.canopy);
    v.group("rows", o.rows);
    v.group("posts", o.posts);
    v.group("registry", o.registry);
    v.group("segments", o.segments);
    v.group("voxel_fit", o.voxel_fit);
    v.group("voxels", o.voxels);
    v.group("beam", o.beam);
    v.group("estimator", o.estimator);
    v.group("integration", o.integration);
    v.group("plan", o.plan);
    v.group("leaf", o.leaf);
    v.group("descriptors", o.descriptors);
    v.group("wood", o.wood);
  }
  /// Ranges, and what has to fit together.
  Result<void> validate() const;
};

}  // namespace rayfield::density
