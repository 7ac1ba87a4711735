#include "formats/zones/zone_table.h"

#include <fmt/format.h>

#include "formats/gis/to_wgs84.h"
#include "formats/picture/color.h"

namespace rayfield::formats {
namespace {

constexpr double kSquareMetresPerHectare = 1e4;

VectorValue text_or_null(const std::string& text) { return text.empty() ? VectorValue() : VectorValue(text); }

std::unique_ptr<OGRGeometry> geometry_of(const ManagementZone& zone) {
  auto all = std::make_unique<OGRMultiPolygon>();
  for (const ZonePart& part : zone.parts) {
    OGRPolygon polygon = ring_polygon(part.exterior);
    for (const auto& hole : part.holes) {
      OGRPolygon inner = ring_polygon(hole);
      polygon.addRing(inner.getExteriorRing());
    }
    all->addGeometry(&polygon);
  }
  return all;
}

}  // namespace

std::vector<VectorColumn> zone_columns(bool with_rates) {
  std::vector<VectorColumn> columns = {
      {"zone", "zone", OFTInteger, "", "number of the zone, from 1: the lowest values"},
      {"area_m2", "area_m2", OFTReal, "m2", "area of the zone on the map"},
      {"area_ha", "area_ha", OFTReal, "ha", "the same in hectares"},
      {"mean", "mean", OFTReal, "unit", "mean of the values in the zone, as measured"},
      {"min", "min", OFTReal, "unit", "smallest value in the zone"},
      {"max", "max", OFTReal, "unit", "largest value in the zone"},
      {"class_low", "class_low", OFTReal, "unit", "lower bound of the zone's smoothed values; NULL: none"},
      {"class_high", "class_high", OFTReal, "unit", "upper bound of the zone's smoothed values; NULL: none"},
      {"measured", "measured", OFTReal, "m or m2", "metres of row, or m² of ground, that the mean is over"},
      {"value", "value", OFTString, "", "what the zones are made of: leaf_area_per_m or plan_density"},
      {"unit", "unit", OFTString, "", "its unit"},
      {"block", "block", OFTString, "", "name of the block"},
      {"farm", "farm", OFTString, "", "name of the farm"},
      {"variety", "variety", OFTString, "", "variety that is grown"},
      {"scan_id", "scan_id", OFTString, "", "identifier of the scan"},
      {"scan_date", "scan_date", OFTDate, "", "local date of the scan"}};
  if (with_rates) {
    columns.insert(columns.begin() + 1, {"rate", "rate", OFTReal, "rate_unit", "what to apply in the zone"});
    columns.push_back({"rate_unit", "rate_unit", OFTString, "", "unit of the rate"});
    columns.push_back({"product", "product", OFTString, "", "what is applied"});
  }
  return columns;
}

Rgba zone_color(const ZoneMap& map, int zone) {
  return color_at({0, static_cast<double>(map.zones.size()), Ramp::canopy}, zone - 0.5);
}

VectorTable zone_table(const ZoneMap& map, const std::optional<Prescription>& rates) {
  VectorTable table{"management_zone", wkbMultiPolygon, zone_columns(rates.has_value()), {}};
  for (const ManagementZone& zone : map.zones) {
    std::vector<VectorValue> values = {std::int64_t{zone.zone},
                                       zone.area_m2,
                                       zone.area_m2 / kSquareMetresPerHectare,
                                       zone.mean,
                                       zone.min,
                                       zone.max,
                                       zone.low,
                                       zone.high,
                                       zone.measured,
                                       map.value,
                                       map.unit,
                                       map.block,
                                       text_or_null(map.farm),
                                       text_or_null(map.variety),
                                       map.scan.scan_id,
                                       map.scan.scan_date};
    if (rates) {
      values.insert(values.begin() + 1, rates->rates[static_cast<std::size_t>(zone.zone - 1)]);
      values.insert(values.end(), {rates->unit, text_or_null(rates->product)});
    }
    table.features.push_back({fmt::format("zone {}", zone.zone), geometry_of(zone), std::move(values),
                              hex_text(zone_color(map, zone.zone))});
  }
  return table;
}

}  // namespace rayfield::formats
