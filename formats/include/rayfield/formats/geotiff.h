#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rayfield/core/products.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/style.h"

/// raster: maps as GeoTIFF: one Float32 band, NaN = not scanned = nodata, unit and description set, statistics inside
/// the file, a QGIS style beside it. Equal input gives equal bytes. See docs/products.md.
namespace rayfield::formats {

struct GeoTiffOptions {
  enum class Profile {
    cloud_optimised,  ///< COG: tiled, compressed, AVERAGE overviews
    plain             ///< untiled, uncompressed, no overviews: for software that reads little else
  };
  Profile profile = Profile::cloud_optimised;

  /// Both lossless, with the floating-point predictor. Deflate is read everywhere; zstd is faster and about a tenth
  /// smaller, and needs a libtiff built with it.
  enum class Compression { deflate, zstd };
  Compression compression = Compression::deflate;

  /// Tile edge of a COG, cells; a multiple of 16, 128 … 4096. Smaller tiles suit web maps, larger ones compress better.
  int block_size = 512;

  /// Rows handed over at a time, 1 … 65536. Memory is rows · width · 4 bytes, and as much again when checking.
  int rows_per_band = 512;

  /// Writes `<stem>.qml` beside the raster.
  bool write_style = true;
  /// Colours of the style; default: the fixed scale of the product (docs/products.md).
  std::optional<ColorScale> scale;

  /// Further metadata items of the file, in this order ("scan_date", "2019-02-11"). Keys: letters, digits, underscore.
  std::vector<std::pair<std::string, std::string>> metadata;

  Result<void> validate() const;
};

/// Where a raster lies and what it holds. Cell (0,0) is the south-west one, as in Grid2.
struct RasterLayout {
  std::string name, unit, description;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< south-west corner, m
  double cell_m = 1;
  int nx = 0, ny = 0;
};

/// Fills `values` (row_count · nx, row by row northwards, index (iy − iy_begin)·nx + ix) with rows iy_begin … iy_begin
/// + row_count − 1. Called once per band, from the north end of the raster to the south end.
using RowReader = std::function<Result<void>(int iy_begin, int row_count, std::span<float> values)>;

/// Writes a raster that is never in memory as a whole. Rows go through a temporary file beside `path` (as large as the
/// raster uncompressed), which the COG's overviews are made from; after writing, the file is read back and its values
/// compared by SHA-256 before it is renamed into place. A stale `<path>.aux.xml` is removed.
/// `crs`: code or WKT. Errors: usage (options, CRS), resources (disk, memory, permission), internal (a cell is
/// infinite, GDAL failed), bad_input (no such folder), and whatever `read` returns.
Result<void> write_cog(const RasterLayout& layout, const RowReader& read, const std::string& crs,
                       const std::string& path, const GeoTiffOptions& options = {});

/// The same for a raster in memory.
Result<void> write_cog(const RasterProduct& raster, const std::string& crs, const std::string& path,
                       const GeoTiffOptions& options = {});

/// Only the QGIS style of a raster, for one whose colours change while its values stay. Errors: usage (a scale without
/// range), resources, bad_input (no such folder).
Result<void> write_raster_style(const ColorScale& scale, const std::string& unit, const std::string& path);

}  // namespace rayfield::formats
