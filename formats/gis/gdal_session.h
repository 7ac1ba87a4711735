#pragma once

/// gis: products for other software, written through GDAL: GeoTIFF, GeoPackage, GeoJSON and CSV.

#include <cpl_error.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::formats {

/// GDAL for the duration of one product, in this thread: drivers registered (once), block cache bounded, errors caught
/// instead of printed, and configuration options set for this thread only.
class GdalSession {
 public:
  /// `options`: thread-local configuration, on top of GDAL_PAM_ENABLED=NO (no .aux.xml) and GDAL_NUM_THREADS=1.
  explicit GdalSession(std::vector<std::pair<std::string, std::string>> options = {});
  ~GdalSession();
  GdalSession(const GdalSession&) = delete;
  GdalSession& operator=(const GdalSession&) = delete;

  /// True once GDAL reported a failure, also from inside a close that has no return value.
  bool failed() const { return !message_.empty(); }

  /// GDAL's first failure as an error: out of disk, memory or permission → resources, the rest → internal.
  tl::unexpected<Error> failure(std::string_view what, std::string_view where) const;

 private:
  static void CPL_STDCALL on_error(CPLErr severity, CPLErrorNum number, const char* message);
  std::vector<std::pair<std::string, std::string>> saved_;
  std::string message_;
  CPLErrorNum number_ = CPLE_None;
};

struct DatasetCloser {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using DatasetPtr = std::unique_ptr<GDALDataset, DatasetCloser>;

/// The failure of what PROJ has just been asked for: resources, where it could not read its database, else usage.
tl::unexpected<Error> crs_failure(std::string_view what, std::string_view where, std::string_view why,
                                  std::string_view next);
/// A CRS from "EPSG:7854", WKT or PROJJSON, with easting first. Files and URLs are refused. Errors: usage, resources.
Result<OGRSpatialReference> parse_crs(const std::string& crs, std::string_view what, std::string_view where);

}  // namespace rayfield::formats
