#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>

#include "rayfield/core/density_points.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/style.h"

/// Point clouds coloured by density (docs/products.md, "Point cloud").
namespace rayfield::formats {

enum class PointCloudFormat {
  ply,  ///< binary, little-endian
  las   ///< LAS 1.4, point data record format 7
};

struct PointCloudOptions {
  std::string crs;       ///< "EPSG:7854", WKT or PROJJSON
  std::string date;      ///< of the scan, YYYY-MM-DD; stands in a LAS header in place of the day of writing
  std::string software;  ///< named in the header, at most 32 characters
  ColorScale scale;      ///< of density, m²/m³
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< LAS: points are within 200 km of it
};

/// Writes points as they come: memory does not grow with their number. NaN densities are grey. The file appears under
/// its name only after close(). Equal points give equal bytes.
class PointCloudWriter {
 public:
  /// Errors: usage (options, CRS), bad_input (no such folder), resources.
  static Result<PointCloudWriter> create(const std::string& path, PointCloudFormat format,
                                         const PointCloudOptions& options);
  PointCloudWriter(PointCloudWriter&&) noexcept;
  PointCloudWriter& operator=(PointCloudWriter&&) noexcept;
  ~PointCloudWriter();

  /// Errors: bad_input (coordinates that are not finite or, in a LAS file, too far from the offset), resources.
  Result<void> write(const DensityPoints& points);
  /// Completes the header, syncs and renames. Nothing can be written afterwards. Errors: resources.
  Result<void> close();
  std::uint64_t point_count() const;

 private:
  struct Impl;
  explicit PointCloudWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayfield::formats
