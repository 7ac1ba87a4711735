#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>

#include "rayfield/core/result.h"
/// frames: from the sensors' local metres to the map and back (PROJ, GeographicLib).
namespace rayfield {

/// What rayfield needs to know of a coordinate reference system.
struct CrsInfo {
  std::string code;  ///< "EPSG:7854" however it was written; as given where it has no code
  std::string name;  ///< "GDA2020 / MGA zone 54"
  std::string wkt;   ///< WKT2:2019
};

/// Looks up a CRS and checks that maps can be made in it: known to PROJ, projected, axes in metres, easting first.
/// Errors: usage, with the reason (unknown code, geographic, feet, south-orientated axes); resources, where PROJ cannot
/// open its database.
Result<CrsInfo> lookup_projected_crs(const std::string& code);

/// Whether two ways to write a CRS mean the same one: "epsg:7854 " and "EPSG:7854".
bool same_crs(const std::string& a, const std::string& b);

/// The checks of a CRS that need no place. Errors: usage, where its grid metres differ from true
/// ones by more than 1 % in most of the area that it is made for (web Mercator); as lookup_projected_crs().
Result<void> check_crs_scale(const std::string& code);

/// The UTM zone of a place on WGS 84, e.g. "EPSG:32632"; empty beyond 84° N and 80° S, where UTM ends.
std::string utm_code(double latitude_deg, double longitude_deg);

/// Checks that a CRS suits a place: areas on the map would be wrong where its grid metres differ from true ones (web
/// Mercator), and a transverse Mercator used on the far side of the Earth is upside down.
/// `latitude_longitude_height` as in MapFrame. Errors: usage, where the scale is off by more than 1 %, grid north by
/// more than 60°, or the place has no coordinates; names the UTM zone that fits.
Result<void> check_crs_suits(const std::string& code, const Eigen::Vector3d& latitude_longitude_height);

/// The same for map coordinates, such as those of a cloud's rays, which may be in degrees, feet or another CRS.
/// Returns a warning where the place lies outside the area of use of the CRS, for example in a neighbouring UTM zone.
/// Errors: usage, as check_crs_suits(), and where the place lies more than 10° outside, or outside and within 1 km of
/// the grid's origin.
Result<std::optional<std::string>> check_map_place(const std::string& code, const Eigen::Vector3d& p_in_map);

/// A projected CRS tied to the geographic datum under it and to a local tangent plane.
/// All functions are const and safe to call from one thread per object (PROJ contexts are not shared).
class MapFrame {
 public:
  /// `code`: a projected CRS as accepted by lookup_projected_crs().
  static Result<MapFrame> create(const std::string& code);

  /// Geodetic (degrees north, degrees east, height above the ellipsoid in m) on the CRS's own datum → map (E, N, h), m.
  Eigen::Vector3d map_from_geodetic(const Eigen::Vector3d& latitude_longitude_height) const;
  /// The inverse of map_from_geodetic().
  Eigen::Vector3d geodetic_from_map(const Eigen::Vector3d& p_in_map) const;

  /// Grid convergence at a map point: the angle from true north to grid north, clockwise positive, rad.
  double convergence_rad(const Eigen::Vector3d& p_in_map) const;
  /// Point scale factor at a map point: grid metres per ellipsoidal metre.
  double scale_factor(const Eigen::Vector3d& p_in_map) const;

  const CrsInfo& crs() const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// A local east-north-up frame, metric and conformal at its origin (GeographicLib LocalCartesian on WGS 84).
class TangentPlane {
 public:
  /// `latitude_longitude_height`: degrees, degrees, m.
  explicit TangentPlane(const Eigen::Vector3d& latitude_longitude_height);
  Eigen::Vector3d enu_from_geodetic(const Eigen::Vector3d& latitude_longitude_height) const;
  Eigen::Vector3d geodetic_from_enu(const Eigen::Vector3d& p_in_enu) const;
  const Eigen::Vector3d& origin() const { return origin_; }

 private:
  Eigen::Vector3d origin_;
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// The 3×3 matrix of ∂map/∂enu at a point near the plane's origin (convergence, scale and Earth curvature to first
/// order), by central differences over ±50 m.
Eigen::Matrix3d map_from_enu_jacobian(const MapFrame& frame, const TangentPlane& plane,
                                      const Eigen::Vector3d& p_in_enu);

}  // namespace rayfield
