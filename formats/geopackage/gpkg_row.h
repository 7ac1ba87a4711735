#pragma once

#include <ogrsf_frmts.h>

#include <cstdint>
#include <string>
#include <vector>

#include "formats/geopackage/gpkg_layers.h"

namespace rayfield::formats::gpkg {

/// One row of a table, filled column by column in the order of its description.
class Row {
 public:
  explicit Row(OGRLayer& layer);
  ~Row();
  Row(const Row&) = delete;
  Row& operator=(const Row&) = delete;

  Row& text(const std::string& value);
  /// Nothing becomes NULL.
  Row& optional_text(const std::string& value);
  Row& integer(std::int64_t value);
  /// NaN (not scanned, undefined) and infinities become NULL.
  Row& real(double value);
  /// `date`: YYYY-MM-DD, already checked; an empty one becomes NULL.
  Row& date(const std::string& date);
  /// ISO 8601 UTC; anything else becomes NULL.
  Row& time(const std::string& utc);
  Row& geometry(const OGRGeometry& geometry);
  bool write();

 private:
  OGRLayer& layer_;
  OGRFeature* feature_;
  int column_ = 0;
};

/// Errors: internal, naming what has a coordinate that is not finite.
Result<void> check_finite(const OpenGeoPackage& package, const std::vector<Eigen::Vector2d>& points,
                          const std::string& of);

/// GDAL's failure, where a row was not written.
Result<void> check_written(const OpenGeoPackage& package, bool written);

/// The panel's outline as a polygon; an outline of fewer than three corners gives none.
Result<void> set_outline(const OpenGeoPackage& package, const PanelProduct& panel, Row& out);

}  // namespace rayfield::formats::gpkg
