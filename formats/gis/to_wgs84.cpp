#include "formats/gis/to_wgs84.h"

#include <cmath>

#include "formats/gis/gdal_session.h"

namespace rayfield::formats {

Result<ToWgs84> ToWgs84::create(const std::string& crs, std::string_view what, std::string_view where) {
  RAYFIELD_ASSIGN(const OGRSpatialReference from, parse_crs(crs, what, where));
  RAYFIELD_ASSIGN(const OGRSpatialReference wgs84, parse_crs("EPSG:4326", what, where));
  ToWgs84 result;
  result.what_ = what, result.where_ = where;
  result.transform_.reset(OGRCreateCoordinateTransformation(&from, &wgs84));
  if (result.transform_ == nullptr)
    return crs_failure(what, where, "no way from " + crs + " to longitude and latitude", "");
  return result;
}

Result<Eigen::Vector2d> ToWgs84::point(const Eigen::Vector2d& p_in_map, const std::string& of) const {
  double x = p_in_map.x(), y = p_in_map.y();
  if (!p_in_map.allFinite() || !transform_->Transform(1, &x, &y) || !std::isfinite(x) || !std::isfinite(y))
    return fail(ErrorCode::internal, what_, where_, of + " has a place without longitude and latitude");
  return Eigen::Vector2d(x, y);
}

Result<void> ToWgs84::move(OGRGeometry& geometry, const std::string& of) const {
  OGREnvelope envelope;
  const bool moved = geometry.transform(transform_.get()) == OGRERR_NONE;
  geometry.getEnvelope(&envelope);
  if (moved && std::isfinite(envelope.MinX + envelope.MaxX + envelope.MinY + envelope.MaxY)) return {};
  return fail(ErrorCode::internal, what_, where_, of + " has a corner without longitude and latitude");
}

std::unique_ptr<OGRPolygon> valid_polygon(const OGRPolygon& polygon) {
  std::unique_ptr<OGRPolygon> best(polygon.clone());
  if (polygon.IsEmpty() || polygon.IsValid()) return best;
  const std::unique_ptr<OGRGeometry> parts(OGRGeometryFactory::forceToMultiPolygon(polygon.Buffer(0)));
  if (parts == nullptr || wkbFlatten(parts->getGeometryType()) != wkbMultiPolygon) return best;
  double area = 0;
  for (const OGRPolygon* part : *parts->toMultiPolygon())
    if (part->get_Area() > area) area = part->get_Area(), best.reset(part->clone());
  return best;
}

OGRPolygon ring_polygon(std::span<const Eigen::Vector2d> ring) {
  OGRPolygon polygon;
  if (ring.size() < 3) return polygon;
  OGRLinearRing line;
  for (const Eigen::Vector2d& p : ring) line.addPoint(p.x(), p.y());
  line.closeRings();
  polygon.addRing(&line);
  return polygon;
}

}  // namespace rayfield::formats
