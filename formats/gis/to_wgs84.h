#pragma once

#include <ogr_geometry.h>
#include <ogr_spatialref.h>

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "rayfield/core/result.h"

namespace rayfield::formats {

/// From a block's CRS to longitude and latitude (WGS 84, EPSG:4326, longitude first).
class ToWgs84 {
 public:
  /// Errors: usage (unknown CRS, or none that leads to longitude and latitude).
  static Result<ToWgs84> create(const std::string& crs, std::string_view what, std::string_view where);

  /// Longitude and latitude of a place, degrees. `of` names it in errors. Errors: internal (no finite coordinates).
  Result<Eigen::Vector2d> point(const Eigen::Vector2d& p_in_map, const std::string& of) const;
  /// Moves a geometry. Errors: as point().
  Result<void> move(OGRGeometry& geometry, const std::string& of) const;

 private:
  struct Closer {
    void operator()(OGRCoordinateTransformation* transform) const { OGRCoordinateTransformation::DestroyCT(transform); }
  };
  std::unique_ptr<OGRCoordinateTransformation, Closer> transform_;
  std::string what_, where_;
};

/// The polygon, or where its border crosses itself the largest of the polygons that GEOS makes of it: readers refuse
/// polygons that are not valid.
std::unique_ptr<OGRPolygon> valid_polygon(const OGRPolygon& polygon);

/// A ring of map coordinates as a polygon, closed; empty for fewer than three corners.
OGRPolygon ring_polygon(std::span<const Eigen::Vector2d> ring);

}  // namespace rayfield::formats
