#include "rayfield/formats/isoxml.h"

#include <fmt/format.h>
#include <ogr_geometry.h>

#include <array>
#include <cmath>
#include <memory>

#include "formats/gis/gdal_session.h"
#include "formats/gis/to_wgs84.h"
#include "formats/io/guard.h"
#include "formats/io/text_escape.h"
#include "formats/io/zip_file.h"
#include "formats/zones/rate_unit.h"
#include "formats/zones/zone_table.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kWhat = "cannot write ISOXML";
/// Treatment zone codes are bytes; 255 is reserved, and 0 is the ground outside of all zones.
constexpr int kMostZones = 254;
// ISO 11783-10, annex D: kinds of polygons and of their rings.
constexpr int kFieldBoundary = 1, kTreatmentZone = 2, kExterior = 1, kInterior = 2;

/// Text of at most 32 characters, as all designators are, for an attribute.
std::string designator(const std::string& text) {
  const std::string clean = clean_text(text);
  std::size_t end = 0, characters = 0;
  for (; end < clean.size(); ++end)
    if ((static_cast<unsigned char>(clean[end]) & 0xC0U) != 0x80U && ++characters > 32) break;
  return xml_escape(clean.substr(0, end));
}

std::string ring_xml(const OGRLinearRing& ring, int kind) {
  std::string text = fmt::format("<LSG A=\"{}\">\n", kind);
  for (int i = 0; i < ring.getNumPoints(); ++i)
    text += fmt::format("<PNT A=\"2\" C=\"{:.9f}\" D=\"{:.9f}\"/>\n", ring.getY(i), ring.getX(i));
  return text + "</LSG>\n";
}

std::string polygon_xml(const OGRPolygon& polygon, int kind, const std::string& name) {
  std::string text = fmt::format("<PLN A=\"{}\" B=\"{}\">\n", kind, name);
  text += ring_xml(*polygon.getExteriorRing(), kExterior);
  for (int i = 0; i < polygon.getNumInteriorRings(); ++i) text += ring_xml(*polygon.getInteriorRing(i), kInterior);
  return text + "</PLN>\n";
}

/// Zones in longitude and latitude, and the boundary of all of them together.
struct Places {
  VectorTable zones;
  std::unique_ptr<OGRGeometry> boundary;
};
Result<Places> places_of(const ZoneMap& map, const GdalSession& gdal, const std::string& path) {
  RAYFIELD_ASSIGN(const ToWgs84 to_wgs84, ToWgs84::create(map.crs, kWhat, path));
  Places places{zone_table(map, {}), nullptr};
  OGRMultiPolygon all;
  for (const VectorFeature& zone : places.zones.features)
    for (const OGRPolygon* part : *zone.geometry->toMultiPolygon()) all.addGeometry(part);
  places.boundary.reset(all.UnionCascaded());
  if (places.boundary == nullptr) return gdal.failure(kWhat, path);
  RAYFIELD_CHECK(to_wgs84.move(*places.boundary, "the block"));
  for (VectorFeature& zone : places.zones.features) RAYFIELD_CHECK(to_wgs84.move(*zone.geometry, zone.label));
  return places;
}

std::string field_xml(const ZoneMap& map, const OGRGeometry& boundary) {
  const std::string block = designator(map.block);
  std::string text = fmt::format("<PFD A=\"PFD1\" C=\"{}\" D=\"{:.0f}\"{}>\n", block, map.area_m2,
                                 map.farm.empty() ? "" : " F=\"FRM1\"");
  if (wkbFlatten(boundary.getGeometryType()) == wkbPolygon) {
    text += polygon_xml(*boundary.toPolygon(), kFieldBoundary, block);
  } else {
    for (const OGRPolygon* part : *boundary.toMultiPolygon()) text += polygon_xml(*part, kFieldBoundary, block);
  }
  return text + "</PFD>\n";
}

std::string setpoint_xml(const RateUnit& unit, double rate) {
  return fmt::format("<PDV A=\"{}\" B=\"{}\" C=\"PDT1\" E=\"VPN1\"/>\n", unit.ddi, std::llround(rate * unit.steps));
}

/// Every polygon is a treatment zone of its own: some terminals read one polygon of a zone only.
Result<std::string> treatment_xml(const ZoneMap& map, const Prescription& rates, const RateUnit& unit,
                                  const Places& places, const std::string& path) {
  std::string text = "<TZN A=\"0\" B=\"outside\">\n" + setpoint_xml(unit, 0) + "</TZN>\n";
  int code = 0;
  for (std::size_t i = 0; i < map.zones.size(); ++i) {
    const auto zone = static_cast<std::size_t>(map.zones[i].zone);
    for (const OGRPolygon* part : *places.zones.features[i].geometry->toMultiPolygon()) {
      if (++code > kMostZones)
        return fail(ErrorCode::usage, kWhat, path, fmt::format("ISOXML takes {} polygons at most", kMostZones),
                    "give a larger --set min_zone_m2 or smoothing_m");
      const std::string name = fmt::format("zone {}", zone);
      text += fmt::format("<TZN A=\"{}\" B=\"{}\">\n", code, name);
      text += polygon_xml(*part, kTreatmentZone, name) + setpoint_xml(unit, rates.rates[zone - 1]) + "</TZN>\n";
    }
  }
  return text;
}

Result<std::string> task_xml(const ZoneMap& map, const Prescription& rates, const std::string& path) {
  const RateUnit* unit = find_rate_unit(rates.unit);
  if (unit == nullptr) return fail(ErrorCode::usage, kWhat, path, "unknown unit " + rates.unit);
  const GdalSession gdal;
  RAYFIELD_ASSIGN(const Places places, places_of(map, gdal, path));
  RAYFIELD_ASSIGN(const std::string treatment, treatment_xml(map, rates, *unit, places, path));
  const bool farm = !map.farm.empty();
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<ISO11783_TaskData VersionMajor=\"3\" VersionMinor=\"3\" "
      "ManagementSoftwareManufacturer=\"rayfield\" ManagementSoftwareVersion=\"1\" DataTransferOrigin=\"1\">\n";
  if (farm) text += fmt::format("<FRM A=\"FRM1\" B=\"{}\"/>\n", designator(map.farm));
  text += field_xml(map, *places.boundary);
  text += fmt::format("<PDT A=\"PDT1\" B=\"{}\" D=\"VPN1\"/>\n", designator(rates.product));
  // A task without a default, with the codes of the ground outside of all zones and of a lost position.
  text += fmt::format("<TSK A=\"TSK1\" B=\"{}\"{} E=\"PFD1\" G=\"1\" H=\"0\" I=\"0\" J=\"0\">\n",
                      designator(rates.product + " " + map.scan.scan_date), farm ? " D=\"FRM1\"" : "");
  text += treatment + "</TSK>\n";
  // Shown value = steps · scale.
  text += fmt::format("<VPN A=\"VPN1\" B=\"0\" C=\"{:.12f}\" D=\"{}\" E=\"{}\"/>\n", 1 / unit->steps, unit->decimals,
                      unit->name);
  return text + "</ISO11783_TaskData>\n";
}

}  // namespace

Result<void> write_isoxml(const ZoneMap& map, const Prescription& rates, const std::string& path) {
  return guarded(kWhat, path, [&]() -> Result<void> {
    RAYFIELD_ASSIGN(const std::string text, task_xml(map, rates, path));
    const std::array<ZipMember, 1> members = {{{"TASKDATA/TASKDATA.XML", text}}};
    return write_zip(members, map.scan.scan_date, path, kWhat);
  });
}

}  // namespace rayfield::formats
