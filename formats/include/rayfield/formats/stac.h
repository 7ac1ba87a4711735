#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"

/// stac: the maps of a block as described by the SpatioTemporal Asset Catalog 1.0.0 with the extensions
/// `projection` and `raster`. One Item per scan with its Cloud Optimised GeoTIFFs as assets, and a Collection of the
/// Items; references are relative, so that the folder can be moved or served as it is.
namespace rayfield::formats {

/// A map of a scan that lies beside the Item.
struct StacAsset {
  std::string product, unit, description;            ///< see RasterProduct
  std::string file_name;                             ///< in the Item's folder
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< south-west corner in the block's CRS, m
  double cell_m = 1;
  int nx = 0, ny = 0;
};

struct StacItem {
  std::string file_name;  ///< of the Item
  ScanProduct scan;
  std::vector<StacAsset> assets;  ///< at least one
};

/// `block`: its name, farm, variety and CRS. Geometries are the assets' outlines in WGS 84, seven decimals; the time is
/// that of the scan, or midnight of its date where that is not known. Equal input gives equal bytes.
/// Errors: usage (CRS, an Item without assets, an invalid date), internal, resources, bad_input (no such folder).
Result<void> write_stac_item(const BlockProducts& block, const StacItem& item, const std::string& collection_file,
                             const std::string& path);
Result<void> write_stac_collection(const BlockProducts& block, std::span<const StacItem> items,
                                   const std::string& path);

}  // namespace rayfield::formats
