#include "rayfield/formats/exchange.h"

#include <fmt/format.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include "formats/gis/gdal_session.h"
#include "formats/gis/measured_columns.h"
#include "formats/io/guard.h"
#include "formats/io/staged_output.h"
#include "formats/io/text_escape.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kGeoJsonWhat = "cannot write GeoJSON", kCsvWhat = "cannot write CSV";

double signed_area(const std::vector<Eigen::Vector2d>& ring) {
  double twice = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d a = ring[i] - ring[0], b = ring[(i + 1) % ring.size()] - ring[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

struct TransformCloser {
  void operator()(OGRCoordinateTransformation* transform) const { OGRCoordinateTransformation::DestroyCT(transform); }
};
using TransformPtr = std::unique_ptr<OGRCoordinateTransformation, TransformCloser>;

/// The GeoJSON geometry of an outline: closed, counter-clockwise, longitude first.
Result<std::string> polygon(const PanelProduct& panel, OGRCoordinateTransformation& to_wgs84, const std::string& path) {
  std::vector<Eigen::Vector2d> ring = panel.outline;
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (ring.size() < 3) return std::string("null");
  if (signed_area(ring) < 0) std::reverse(ring.begin(), ring.end());
  ring.push_back(ring.front());
  std::string text;
  for (const Eigen::Vector2d& p : ring) {
    double x = p.x(), y = p.y();
    if (!p.allFinite() || !to_wgs84.Transform(1, &x, &y) || !std::isfinite(x) || !std::isfinite(y)) {
      return fail(
          ErrorCode::internal, kGeoJsonWhat, path,
          fmt::format("panel {}/{} has a corner without longitude and latitude", panel.row_number, panel.panel_number));
    }
    text += fmt::format("{}[{:.9f},{:.9f}]", text.empty() ? "" : ",", x, y);
  }
  return fmt::format("{{\"type\":\"Polygon\",\"coordinates\":[[{}]]}}", text);
}

std::string properties(const PanelProduct& panel, const PanelValue* value) {
  std::string text = fmt::format("\"panel_uid\":{},\"row_number\":{},\"panel_number\":{},\"length_m\":{}",
                                 json_string(panel.panel_uid), panel.row_number, panel.panel_number,
                                 number_text(panel.length_m, "null"));
  if (value == nullptr) return text;
  text += fmt::format(",\"scan_id\":{},\"scan_date\":{}", json_string(value->scan_id), json_string(value->scan_date));
  for (const MeasuredColumn& column : kMeasuredColumns)
    text += fmt::format(",\"{}\":{}", column.name, number_text(value->*column.value, "null"));
  return text + fmt::format(",\"ray_count\":{},\"wood_scan_id\":{}", value->ray_count,
                            value->wood_scan_id.empty() ? "null" : json_string(value->wood_scan_id));
}

Result<std::string> geojson(const BlockProducts& block, std::size_t scan_index, const std::string& path) {
  if (scan_index >= block.scans.size()) {
    return fail(ErrorCode::usage, kGeoJsonWhat, path,
                fmt::format("scan {} of {} was asked for", scan_index + 1, block.scans.size()));
  }
  RAYFIELD_ASSIGN(OGRSpatialReference crs, parse_crs(block.crs, kGeoJsonWhat, path));
  RAYFIELD_ASSIGN(OGRSpatialReference wgs84, parse_crs("EPSG:4326", kGeoJsonWhat, path));
  const TransformPtr to_wgs84(OGRCreateCoordinateTransformation(&crs, &wgs84));
  if (to_wgs84 == nullptr) {
    return fail(ErrorCode::usage, kGeoJsonWhat, path, "no way from " + block.crs + " to longitude and latitude");
  }
  std::map<std::string, const PanelValue*> values;
  for (const PanelValue& value : block.scans[scan_index].panel_values) values[value.panel_uid] = &value;
  std::string features;
  for (const PanelProduct& panel : block.panels) {
    RAYFIELD_ASSIGN(const std::string geometry, polygon(panel, *to_wgs84, path));
    const auto found = values.find(panel.panel_uid);
    features += fmt::format("{}\n{{\"type\":\"Feature\",\"id\":{},\"geometry\":{},\"properties\":{{{}}}}}",
                            features.empty() ? "" : ",", json_string(panel.panel_uid), geometry,
                            properties(panel, found == values.end() ? nullptr : found->second));
  }
  // A member of our own beside RFC 7946's, which its section 6.1 allows.
  return fmt::format("{{\"type\":\"FeatureCollection\",\"snapshot\":{},\"features\":[{}\n]}}\n", block.snapshot,
                     features);
}

std::string panels_csv(const BlockProducts& block) {
  std::string text = "panel_uid,row_number,panel_number,length_m,scan_id,scan_date";
  for (const MeasuredColumn& column : kMeasuredColumns) text += fmt::format(",{}", column.name);
  text += ",ray_count,wood_scan_id\n";
  std::map<std::string, const PanelProduct*> panels;
  for (const PanelProduct& panel : block.panels) panels[panel.panel_uid] = &panel;
  for (const ScanResults& scan : block.scans) {
    for (const PanelValue& value : scan.panel_values) {
      const auto found = panels.find(value.panel_uid);
      if (found == panels.end()) continue;  // as in the view, which joins the two tables
      const PanelProduct& panel = *found->second;
      text += fmt::format("{},{},{},{},{},{}", csv_escape(value.panel_uid), panel.row_number, panel.panel_number,
                          number_text(panel.length_m, ""), csv_escape(value.scan_id), csv_escape(value.scan_date));
      for (const MeasuredColumn& column : kMeasuredColumns)
        text.append(",").append(number_text(value.*column.value, ""));
      text += fmt::format(",{},{}\n", value.ray_count, csv_escape(value.wood_scan_id));
    }
  }
  return text;
}

std::string row_metres_csv(const BlockProducts& block) {
  std::string text = "row_number,chainage_m,easting_m,northing_m,scan_id,scan_date,leaf_area_per_m,plant_area_per_m\n";
  for (const ScanResults& scan : block.scans) {
    for (const RowMetreProduct& metre : scan.row_metres) {
      text += fmt::format("{},{},{},{},{},{},{},{}\n", metre.row_number, number_text(metre.chainage_m, ""),
                          number_text(metre.position.x(), ""), number_text(metre.position.y(), ""),
                          csv_escape(metre.scan_id), csv_escape(metre.scan_date),
                          number_text(metre.leaf_area_per_m, ""), number_text(metre.plant_area_per_m, ""));
    }
  }
  return text;
}

}  // namespace

Result<void> write_panels_geojson(const BlockProducts& block, std::size_t scan_index, const std::string& path) {
  return guarded(kGeoJsonWhat, path, [&]() -> Result<void> {
    const GdalSession gdal;
    RAYFIELD_ASSIGN(const std::string text, geojson(block, scan_index, path));
    return write_file_atomically(path, text, kGeoJsonWhat);
  });
}

Result<void> write_panels_csv(const BlockProducts& block, const std::string& path) {
  return guarded(kCsvWhat, path, [&] { return write_file_atomically(path, panels_csv(block), kCsvWhat); });
}

Result<void> write_row_metres_csv(const BlockProducts& block, const std::string& path) {
  return guarded(kCsvWhat, path, [&] { return write_file_atomically(path, row_metres_csv(block), kCsvWhat); });
}

}  // namespace rayfield::formats
