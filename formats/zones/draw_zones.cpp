#include "rayfield/formats/draw_zones.h"

#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_alg.h>
#include <ogr_api.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/gis/gdal_session.h"
#include "formats/gis/to_wgs84.h"
#include "formats/io/guard.h"
#include "formats/zones/zone_faces.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kWhat = "cannot draw zones";
/// How far contours may be moved to make them simpler, in cells.
constexpr double kSimplify_cells = 0.2;
using Geometry = std::unique_ptr<OGRGeometry>;

/// The ground that the bands cover. Gaps between rows whose distances vary are closed by growing and shrinking.
Geometry outline_of(std::span<const std::vector<Eigen::Vector2d>> bands) {
  OGRMultiPolygon all;
  double narrowest = std::numeric_limits<double>::infinity();
  for (const std::vector<Eigen::Vector2d>& band : bands) {
    const std::unique_ptr<OGRPolygon> polygon = valid_polygon(ring_polygon(band));
    if (polygon->IsEmpty()) continue;
    const OGRLinearRing* ring = polygon->getExteriorRing();
    narrowest = std::min(narrowest, 2 * polygon->get_Area() / ring->get_Length());  // about a long band's width
    all.addGeometry(polygon.get());
  }
  if (all.IsEmpty()) return nullptr;
  const Geometry joined(all.UnionCascaded());
  const Geometry grown(joined == nullptr ? nullptr : joined->Buffer(narrowest / 4));
  Geometry closed(grown == nullptr ? nullptr : grown->Buffer(-narrowest / 4));
  // Growing and shrinking moves corners by nothing that matters; simplifying takes the vertices it left.
  return Geometry(closed == nullptr ? nullptr : closed->SimplifyPreserveTopology(0.01));
}

/// Lines at which the surface has one of the values, simplified without letting them cross.
Result<Geometry> contours(const Grid2<double>& surface, std::span<const double> breaks, const GdalSession& gdal) {
  if (breaks.empty()) return std::make_unique<OGRMultiLineString>();
  GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
  GDALDriver* vector = GetGDALDriverManager()->GetDriverByName("Memory");
  if (memory == nullptr || vector == nullptr) return fail(ErrorCode::internal, kWhat, "", "GDAL has no memory driver");
  const DatasetPtr raster(memory->Create("", surface.nx, surface.ny, 1, GDT_Float64, nullptr));
  const DatasetPtr lines(vector->Create("", 0, 0, 0, GDT_Unknown, nullptr));
  if (raster == nullptr || lines == nullptr) return gdal.failure(kWhat, "");
  double transform[6] = {surface.origin.x(), surface.cell_m, 0, surface.origin.y(), 0, surface.cell_m};
  raster->SetGeoTransform(transform);
  GDALRasterBand* band = raster->GetRasterBand(1);
  std::vector<double> values = surface.values;
  if (band->RasterIO(GF_Write, 0, 0, surface.nx, surface.ny, values.data(), surface.nx, surface.ny, GDT_Float64, 0, 0,
                     nullptr) != CE_None)
    return gdal.failure(kWhat, "");
  OGRLayer* layer = lines->CreateLayer("contours", nullptr, wkbLineString, nullptr);
  CPLStringList options;
  options.SetNameValue("FIXED_LEVELS", fmt::format("{}", fmt::join(breaks, ",")).c_str());
  if (layer == nullptr || GDALContourGenerateEx(GDALRasterBand::ToHandle(band), OGRLayer::ToHandle(layer),
                                                options.List(), nullptr, nullptr) != CE_None)
    return gdal.failure(kWhat, "");
  OGRMultiLineString all;
  for (auto& feature : *layer)
    if (feature->GetGeometryRef() != nullptr) all.addGeometry(feature->GetGeometryRef());
  if (all.IsEmpty()) return Geometry(all.clone());
  Geometry simple(all.SimplifyPreserveTopology(kSimplify_cells * surface.cell_m));
  if (simple == nullptr) return gdal.failure(kWhat, "");
  return simple;
}

/// The surface at a place, between the centres of four cells.
double value_at(const Grid2<double>& surface, double x, double y) {
  const Eigen::Vector2d place = (Eigen::Vector2d(x, y) - surface.origin).array() / surface.cell_m - 0.5;
  const int ix = std::clamp(static_cast<int>(std::floor(place.x())), 0, std::max(surface.nx - 2, 0));
  const int iy = std::clamp(static_cast<int>(std::floor(place.y())), 0, std::max(surface.ny - 2, 0));
  const int jx = std::min(ix + 1, surface.nx - 1), jy = std::min(iy + 1, surface.ny - 1);
  const double fx = std::clamp(place.x() - ix, 0.0, 1.0), fy = std::clamp(place.y() - iy, 0.0, 1.0);
  return (1 - fy) * ((1 - fx) * surface.at(ix, iy) + fx * surface.at(jx, iy)) +
         fy * ((1 - fx) * surface.at(ix, jy) + fx * surface.at(jx, jy));
}

/// Cuts the outline along the lines, and gives each face the class of the surface inside it.
Result<std::vector<ZoneFace>> cut(const OGRGeometry& outline, const OGRGeometry& lines, const Grid2<double>& surface,
                                  std::span<const double> breaks, const GdalSession& gdal) {
  const Geometry border(outline.Boundary());
  const Geometry noded(border == nullptr ? nullptr : OGRGeometryFactory::forceToMultiLineString(border->Union(&lines)));
  const Geometry polygons(noded == nullptr ? nullptr : noded->Polygonize());
  if (polygons == nullptr) return gdal.failure(kWhat, "");
  std::vector<ZoneFace> faces;
  for (const OGRGeometry* geometry : *polygons->toGeometryCollection()) {
    const OGRPolygon* polygon = geometry->toPolygon();
    const Geometry place(OGRGeometry::FromHandle(
        OGR_G_PointOnSurface(OGRGeometry::ToHandle(const_cast<OGRPolygon*>(polygon)))));  // which reads only
    if (place == nullptr || !outline.Intersects(place.get())) continue;                   // a contour outside
    const OGRPoint* p = place->toPoint();
    const double value = value_at(surface, p->getX(), p->getY());
    const auto zone = std::upper_bound(breaks.begin(), breaks.end(), value) - breaks.begin();
    faces.push_back({std::unique_ptr<OGRPolygon>(polygon->clone()), polygon->get_Area(), static_cast<int>(zone)});
  }
  if (faces.empty()) return fail(ErrorCode::internal, kWhat, "", "the block has no area");
  return faces;
}

std::vector<Eigen::Vector2d> ring_of(const OGRLinearRing& line, bool clockwise) {
  std::vector<Eigen::Vector2d> ring;
  for (int i = 0; i < line.getNumPoints(); ++i) ring.emplace_back(line.getX(i), line.getY(i));
  if ((line.isClockwise() != 0) != clockwise) std::reverse(ring.begin(), ring.end());
  return ring;
}

void add_part(const OGRPolygon& polygon, ManagementZone& zone) {
  ZonePart part{ring_of(*polygon.getExteriorRing(), false), {}};
  for (int i = 0; i < polygon.getNumInteriorRings(); ++i)
    part.holes.push_back(ring_of(*polygon.getInteriorRing(i), true));
  zone.area_m2 += polygon.get_Area();
  zone.parts.push_back(std::move(part));
}

/// Joins the faces of each zone.
Result<std::vector<ManagementZone>> join(const std::vector<ZoneFace>& faces, std::span<const double> breaks,
                                         const GdalSession& gdal) {
  constexpr double kOpen = std::numeric_limits<double>::infinity();
  std::vector<ManagementZone> zones;
  for (int z = 0; z <= static_cast<int>(breaks.size()); ++z) {
    OGRMultiPolygon all;
    for (const ZoneFace& face : faces)
      if (face.zone == z) all.addGeometry(face.polygon.get());
    if (all.IsEmpty()) continue;
    const Geometry joined(all.UnionCascaded());
    if (joined == nullptr) return gdal.failure(kWhat, "");
    const auto i = static_cast<std::size_t>(z);
    ManagementZone zone{static_cast<int>(zones.size()) + 1,
                        z == 0 ? -kOpen : breaks[i - 1],
                        i == breaks.size() ? kOpen : breaks[i],
                        {}};
    if (wkbFlatten(joined->getGeometryType()) == wkbPolygon)
      add_part(*joined->toPolygon(), zone);
    else
      for (const OGRPolygon* polygon : *joined->toMultiPolygon()) add_part(*polygon, zone);
    zones.push_back(std::move(zone));
  }
  return zones;
}

}  // namespace

Result<std::vector<ManagementZone>> draw_zones(const Grid2<double>& surface, std::span<const double> breaks,
                                               std::span<const std::vector<Eigen::Vector2d>> bands,
                                               double min_zone_m2) {
  return guarded(kWhat, "", [&]() -> Result<std::vector<ManagementZone>> {
    const GdalSession gdal;
    const Geometry outline = outline_of(bands);
    if (outline == nullptr)
      return fail(ErrorCode::bad_input, kWhat, "", "the block has no rows on that date", "give another --date");
    RAYFIELD_ASSIGN(const Geometry lines, contours(surface, breaks, gdal));
    RAYFIELD_ASSIGN(std::vector<ZoneFace> faces, cut(*outline, *lines, surface, breaks, gdal));
    absorb_small_parts(faces, shared_borders(faces), min_zone_m2);
    return join(faces, breaks, gdal);
  });
}

}  // namespace rayfield::formats
