#pragma once
/// leaf: leaf areas: plants less the wood that a dormant scan shows or the canopy lets expect (docs/density.md).

#include <optional>
#include <string>
#include <vector>

#include "libdensity/echoes/echo_model.h"
#include "libdensity/layout/row_layout.h"
#include "libdensity/leaf/scan_totals.h"
#include "libdensity/leaf_angles/leaf_angle_fit.h"
#include "libdensity/scan/scan_work.h"
#include "libdensity/voxels/row_segments.h"
#include "libdensity/voxels/wood.h"
#include "rayfield/core/products.h"
#include "rayfield/density/options.h"

namespace rayfield::density {

/// The voxels of a scan whose rays have been counted.
struct ScanVoxels {
  RowSegmentList row_segments;
  std::vector<WoodCylinder> wood;            ///< masked posts and trunks
  std::vector<tile::TileIndex> tiles;        ///< with counters
  std::optional<EchoModel> echoes = {};      ///< of beams that are not thin; then the counters have EchoCounters
  LeafAngleFit leaf_angles = {};             ///< what was measured of them
  std::vector<int> rows_from_one_side = {};  ///< Row::number (scan_sides.h)
};

/// The options of integration with what all panels of the scan are off by alike: what the width of its beam and the
/// angles of its leaves leave open.
IntegrationOptions integration_of_scan(const ScanWork& work, const ScanVoxels& voxels);

/// The dormant scan whose wood is subtracted.
struct WoodScan {
  const tile::ScanEntry& scan;
  VoxelOptions voxels;  ///< which of its rays are counted
};

/// The scan of a season that shows the least plants, and with that the most wood that there can be.
struct BarestScan {
  std::string scan_id;
  PanelPlants plants;
};

/// Names the rays of a scan.
std::string content_of(const tile::ScanEntry& scan);

/// What the scan's own rays say, from its files; without the sections.
Result<ScanResults> read_results(const ScanWork& work, const RowLayout& layout);

struct LeafReport {
  double leaf_area_m2 = 0;         ///< sum over the panels
  double low_m2 = 0, high_m2 = 0;  ///< sums of the ends of their intervals
  std::size_t panels = 0;
  std::size_t without_wood = 0;  ///< panels that have a plant area but no leaf area: the dormant scan shows too little
};

/// Leaf areas of a scan (kinds "leaf" and "raster", name kLeafRasterName). The dormant scan's rays are counted in the
/// voxels of this one (kind "voxels", names "wood_<tile>") and estimated as its own are, for leaves of the same size,
/// and with the same meaning of their echoes if both were made with one beam, so that what is wrong about both cancels;
/// then wood is subtracted voxel by voxel. Where `wood` is the scan itself, leaf areas are 0. Needs the scan's voxels,
/// results and rasters in its files.
Result<LeafReport> separate_leaves(ScanWork& work, const RowLayout& layout, const ScanVoxels& voxels,
                                   const WoodScan& wood);

/// The same where no dormant scan shows the wood: what is believed of it takes its place (wood_estimate.h), which is no
/// more than `barest` shows.
Result<LeafReport> separate_leaves_by_estimate(ScanWork& work, const RowLayout& layout, const ScanVoxels& voxels,
                                               const std::optional<BarestScan>& barest);
/// LeafValues::wood_content of such leaf areas.
std::string estimate_content(const std::optional<BarestScan>& barest);

/// Those that are in the scan's files already.
Result<LeafReport> read_leaves(ScanWork& work, const RowLayout& layout);

}  // namespace rayfield::density
