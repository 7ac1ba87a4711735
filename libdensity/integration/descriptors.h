#pragma once

#include <span>
#include <vector>

#include "libdensity/estimate/row_density.h"
#include "libdensity/layout/row_layout.h"
#include "rayfield/core/products.h"
#include "rayfield/density/options.h"

/// What growers ask of a canopy, from the densities of a row (docs/descriptors.md). Lines across the row at a height
/// and a chainage stand for the needle of a point quadrat; the number of leaves that they meet follows from what the
/// voxels along them hold.
namespace rayfield::density {

struct DescriptorSettings {
  DescriptorOptions options;
  double height_share = 0.97;  ///< the canopy's upper edge has this share of its area below, the lower edge above it
  double width_share = 0.96;   ///< across the row the canopy holds this share of its area
  double metre_step_m = 0.5;
  double projection = 0.5;  ///< of the leaves' area on a plane along the row
};
DescriptorSettings descriptor_settings(const ProcessOptions& options, const LeafAngles& leaf_angles);

/// Half a metre of row seen from the side. Heights are above the ground.
struct StretchOutline {
  bool is_seen = false;    ///< by rays; else nothing is known
  bool is_canopy = false;  ///< seen, and not a gap
  double base_m = CanopyDescriptors::kUndefined, height_m = CanopyDescriptors::kUndefined,
         width_m = CanopyDescriptors::kUndefined;  ///< of gaps: undefined, 0, 0
};

/// Of a row, in steps of metre_step_m. Masked wood is no canopy. A half metre is a gap if it has no canopy, or less
/// area than gap_area_share of the upper quartile (nearest rank) of those that were seen.
std::vector<StretchOutline> canopy_outline(const RowDensity& row, double row_length_m,
                                           const DescriptorSettings& settings);
/// The same from the stored values of a row's half metres.
std::vector<StretchOutline> outline_of(std::span<const RowMetreProduct> metres, int row_number);
/// Writes height, width, lower edge and gap of half metres, which are in the order of the outline.
void put_outline(std::span<const StretchOutline> outline, std::span<RowMetreProduct> metres);

/// What the lines of a row meet, inside its outline.
class RowLines {
 public:
  /// `row`: of plants, or of leaves alone (subtract_wood). With L the projected area of the voxels along a line of
  /// voxels per area of their face, averaged over 3 × 3 lines inside the outline, and g the share of these lines' faces
  /// that one leaf covers, a point of the face meets n = L/g leaves with the chance g each (positive binomial, Nilson
  /// 1971): none with (1−g)ⁿ, one with L·(1−g)ⁿ⁻¹. Whole leaves come and go, so that L varies from place to place as
  /// Poisson numbers do; unlike exp(−L) the means of these are then free of bias.
  RowLines(const RowDensity& row, double row_length_m, std::span<const StretchOutline> outline,
           const DescriptorSettings& settings);

  /// Of each panel. Of `values` the width is used; where it is NaN everything is. The lower edge is kept.
  void describe_panels(std::span<const Panel> panels, std::span<PanelValue> values) const;
  /// Of each half metre, in the outline's order; the lower edge and the gap are kept.
  void describe_metres(std::span<RowMetreProduct> metres) const;

 private:
  struct ColumnSums {
    double faces = 0;     ///< lines of voxels inside the outline, by the share of their face in it
    double contacts = 0;  ///< sum of L over these
    double smooth = 0;    ///< of its means over 3 × 3
    double open = 0, outer = 0;
    double zone_m2 = 0;  ///< area in the fruit zone
    bool is_seen = false, is_gap = false;
  };
  const RowDensity& row_;
  double row_length_m_;
  std::vector<StretchOutline> outline_;
  DescriptorSettings settings_;
  std::vector<ColumnSums> columns_;  ///< per along index
  CanopyDescriptors describe(double from_m, double to_m, double length_m, double width_m) const;
};

/// Areas of a panel between two heights.
struct BandAreas {
  double low_m = 0, high_m = 0;
  double plant_area_m2 = 0;   ///< with masked wood
  double canopy_area_m2 = 0;  ///< without
};
/// Of each panel, bands of profile_band_m at its multiples, from the grid's low face to its top. Voxels cut by the
/// border of a band are shared by height, and so bands add up to the areas of integrate_panels().
std::vector<std::vector<BandAreas>> vertical_profiles(const RowDensity& row, std::span<const Panel> panels,
                                                      double profile_band_m);

}  // namespace rayfield::density
