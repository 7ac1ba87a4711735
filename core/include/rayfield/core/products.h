#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "rayfield/core/grid2.h"

/// What rayfield delivers, as plain values: filled by libdensity, written by formats. Map coordinates are easting and
/// northing in the store's CRS, m. NaN = not scanned or undefined, 0 = scanned and empty.
namespace rayfield {

/// A row of vines. Row numbers are the farm's own, or count from 1 across the block; panel numbers from 1 along the
/// row. Dates `valid_from` and `valid_to` (the first day on which it is gone) are YYYY-MM-DD; empty = unknown.
struct RowProduct {
  std::string row_uid;
  int row_number = 0;
  std::vector<Eigen::Vector2d> centreline;  ///< from the row's start to its end
  double length_m = 0;
  double spacing_m = 0;  ///< mean distance to the neighbouring rows; NaN for a single row
  std::string row_name = {}, valid_from = {}, valid_to = {};
  std::string source = {};  ///< "surveyed", or "found in <scan>"
};

struct PanelProduct {
  std::string panel_uid;
  int row_number = 0, panel_number = 0;
  double chainage_start_m = 0, chainage_end_m = 0;  ///< along the row's centreline
  double length_m = 0;
  std::vector<Eigen::Vector2d> outline;  ///< closed ring, counter-clockwise
  std::string row_name = {}, valid_from = {}, valid_to = {}, source = {};
};

struct PostProduct {
  std::string post_uid;
  int row_number = 0;
  double chainage_m = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double ground_m = 0;   ///< height of the ground at the post
  double height_m = 0;   ///< above the ground
  bool detected = true;  ///< false: expected from the regular spacing or the survey, but not yet seen in a scan
  std::string row_name = {}, valid_from = {}, valid_to = {}, source = {};
};

/// Values of `wood_from`: what tells the wood that leaf areas are freed of. Empty: nothing, they hold it.
inline constexpr const char* kWoodFromDormantScan = "dormant scan";
inline constexpr const char* kWoodFromEstimate = "estimate";

/// How dense, open and continuous the canopy of a stretch of row is (docs/descriptors.md). Values along lines across
/// the row are averaged over the canopy's outline seen from the side: all half metres that are not gaps, each between
/// its own lower and upper edge. NaN = not scanned, or undefined because there is no canopy.
struct CanopyDescriptors {
  static constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
  double canopy_base_m = kUndefined;          ///< lower edge of the canopy above the ground
  double row_gap_share = kUndefined;          ///< share of the row's length without canopy, by half metres
  double porosity = kUndefined;               ///< share of lines that meet neither leaf nor wood
  double leaf_layer_number = kUndefined;      ///< leaves that a line meets, mean
  double exposed_leaf_share = kUndefined;     ///< share of these that are the first or the last of their line
  double fruit_zone_area_per_m = kUndefined;  ///< one-sided leaf area between two heights per metre of row, m²/m
  double fruit_zone_density = kUndefined;     ///< the same per volume, over the canopy's width, m²/m³
};

struct ScanProduct {
  std::string scan_id;
  std::string scan_date;  ///< YYYY-MM-DD
  std::string name;
  std::string start_utc, end_utc;
  std::uint64_t ray_count = 0;
  // How the scan was moved onto the block's reference; NaN where that is not known.
  double offset_e_m = 0, offset_n_m = 0, offset_h_m = 0;  ///< of its middle
  double yaw_mrad = 0;                                    ///< from east to north
  double residual_m = 0;                                  ///< of posts and trunks in plan, rms
  int landmarks = 0;                                      ///< matched posts and trunks
  bool aligned = true;                                    ///< false: left where its own positioning put it
  std::string wood_scan_id;  ///< dormant scan whose wood was subtracted for the leaf areas; empty: none
  std::string leaf_note;     ///< what the leaf areas include where it is not leaves alone
  double fruit_zone_low_m = CanopyDescriptors::kUndefined;  ///< heights between which the fruit zone was taken
  double fruit_zone_high_m = CanopyDescriptors::kUndefined;
  std::string wood_from = {};  ///< kWoodFromDormantScan, kWoodFromEstimate, or empty
};

/// One panel on one date. Areas are one-sided.
struct PanelValue {
  std::string panel_uid, scan_id, scan_date;
  double plant_area_m2 = 0;  ///< everything that stops rays: leaves, wood, posts, wires
  double leaf_area_m2 = 0;   ///< plant area less the wood that `wood_from` tells
  double leaf_area_per_m = 0;
  double lai = 0;  ///< leaf area / (panel length × row spacing)
  double se_leaf_area_m2 = 0;
  double ci_low_m2 = 0, ci_high_m2 = 0;  ///< 95 % interval of leaf_area_m2
  double canopy_height_m = 0;
  double canopy_width_m = 0;
  double gap_fraction = 0;       ///< share of the panel's side view that lets light through
  double observed_fraction = 0;  ///< share of voxels crossed by at least two rays
  std::int64_t ray_count = 0;
  double se_plant_area_m2 = 0;
  double plant_ci_low_m2 = 0, plant_ci_high_m2 = 0;  ///< 95 % interval of plant_area_m2
  std::string wood_scan_id;                          ///< dormant scan whose wood was subtracted; empty: none
  CanopyDescriptors descriptors = {};
  std::string wood_from = {};  ///< as the scan's
};

/// The areas of a panel between two heights above the ground, on one date. Bands of a panel add up to its areas.
struct PanelProfileBand {
  std::string panel_uid, scan_id, scan_date;
  double height_low_m = 0, height_high_m = 0;
  double plant_area_m2 = 0, leaf_area_m2 = 0;  ///< as PanelValue's
};

/// Half a metre of row on one date.
struct RowMetreProduct {
  int row_number = 0;
  double chainage_m = 0;  ///< centre of the half metre
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  std::string scan_id, scan_date;
  double leaf_area_per_m = 0, plant_area_per_m = 0;
  double canopy_height_m = CanopyDescriptors::kUndefined, canopy_width_m = CanopyDescriptors::kUndefined;
  CanopyDescriptors descriptors = {};
};

/// One map of one date; cell (0,0) is the south-west one, NaN = not scanned.
struct RasterProduct {
  std::string name;  ///< "plan_density", "plan_density_se", "canopy_height", "ground"
  std::string unit;  ///< "m2/m2", "m"
  std::string description;
  Grid2<float> grid;
};

/// A vertical section, for pictures and engineering frames: x along (or across) the row from 0, y height above ground.
struct SectionProduct {
  std::string name;  ///< "side_view_row_3", "end_on_row_3"
  std::string unit;
  int row_number = 0;
  Grid2<float> grid;
};

/// Everything known of one scan of a block.
struct ScanResults {
  ScanProduct scan;
  std::vector<PanelValue> panel_values;
  std::vector<RowMetreProduct> row_metres;
  std::vector<SectionProduct> sections;
  double leaf_size_m2 = 0;                     ///< of one leaf, as measured from neighbouring beams or given
  std::vector<PanelProfileBand> profile = {};  ///< panel by panel, from below
};

/// A block with all its dates. Rasters are not in it: they are large.
struct BlockProducts {
  std::string block;           ///< its name: the store's folder's, or the one it was given
  std::string crs;             ///< "EPSG:7854"
  std::uint64_t snapshot = 0;  ///< the store's snapshot that the products come from; 0: not from a store
  std::vector<RowProduct> rows;
  std::vector<PanelProduct> panels;
  std::vector<PostProduct> posts;
  std::vector<ScanResults> scans;       ///< in the order of their dates
  std::string farm = {}, variety = {};  ///< as named by the user; may be empty
};

}  // namespace rayfield
