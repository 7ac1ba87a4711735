#include "rayfield/formats/exchange.h"

#include <fmt/format.h>

#include <map>
#include <vector>

#include "formats/exchange/panel_table.h"
#include "formats/exchange/shapefile_zip.h"
#include "formats/gis/descriptor_columns.h"
#include "formats/gis/measured_columns.h"
#include "formats/gis/to_wgs84.h"
#include "formats/gis/vector_file.h"
#include "formats/io/guard.h"
#include "formats/io/staged_output.h"
#include "formats/io/text_escape.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kShapefileWhat = "cannot write shapefile", kCsvWhat = "cannot write CSV";

struct FormatText {
  VectorFormat format;
  std::string_view what;
};
FormatText format_text(PanelFormat format, std::uint64_t snapshot) {
  switch (format) {
    case PanelFormat::geojson:
      return {geojson_format(snapshot, "panel_uid"), "cannot write GeoJSON"};
    case PanelFormat::kml:
      return {kml_format(), "cannot write KML"};
    case PanelFormat::flatgeobuf:
      return {flatgeobuf_format(), "cannot write FlatGeobuf"};
    case PanelFormat::geoparquet:
      break;
  }
  return {geoparquet_format(), "cannot write GeoParquet"};
}

// GDAL's CSV driver writes 15 digits, which do not read back as the same number: these files are written as text.

std::string place_fields(const BlockProducts& block, const std::string& longitude_latitude) {
  return fmt::format(",{},{},{},{}\n", csv_escape(block.block), csv_escape(block.farm), csv_escape(block.variety),
                     longitude_latitude);
}
std::string descriptor_names() {
  std::string text;
  for (const DescriptorColumn& column : kDescriptorColumns) text += fmt::format(",{}", column.name);
  return text;
}
std::string descriptor_fields(const CanopyDescriptors& descriptors) {
  std::string text;
  for (const DescriptorColumn& column : kDescriptorColumns)
    text.append(",").append(number_text(descriptors.*column.value, ""));
  return text;
}
std::string place_text(const Eigen::Vector2d& longitude_latitude) {
  return fmt::format("{:.9f},{:.9f}", longitude_latitude.x(), longitude_latitude.y());
}

std::map<std::string, const PanelProduct*> panels_by_uid(const BlockProducts& block) {
  std::map<std::string, const PanelProduct*> panels;
  for (const PanelProduct& panel : block.panels) panels[panel.panel_uid] = &panel;
  return panels;
}

Result<std::map<std::string, std::string>> panel_centres(const BlockProducts& block, const ToWgs84& to_wgs84) {
  std::map<std::string, std::string> centres;
  for (const PanelProduct& panel : block.panels) {
    OGRPoint centre;
    const OGRPolygon outline = ring_polygon(panel.outline);
    std::string& text = centres[panel.panel_uid] = ",";
    if (outline.IsEmpty() || outline.Centroid(&centre) != OGRERR_NONE) continue;
    RAYFIELD_ASSIGN(const Eigen::Vector2d place,
                    to_wgs84.point({centre.getX(), centre.getY()},
                                   fmt::format("panel {}/{}", panel.row_number, panel.panel_number)));
    text = place_text(place);
  }
  return centres;
}

Result<std::string> panels_csv(const BlockProducts& block, const std::string& path) {
  RAYFIELD_ASSIGN(const ToWgs84 to_wgs84, ToWgs84::create(block.crs, kCsvWhat, path));
  RAYFIELD_ASSIGN(const auto centres, panel_centres(block, to_wgs84));
  std::string text = "panel_uid,row_number,panel_number,length_m,scan_id,scan_date";
  for (const MeasuredColumn& column : kMeasuredColumns) text += fmt::format(",{}", column.name);
  text += ",ray_count,wood_scan_id" + descriptor_names() + ",wood_from,block,farm,variety,longitude,latitude\n";
  const auto panels = panels_by_uid(block);
  for (const ScanResults& scan : block.scans) {
    for (const PanelValue& value : scan.panel_values) {
      const auto found = panels.find(value.panel_uid);
      if (found == panels.end()) continue;  // as in the view, which joins the two tables
      const PanelProduct& panel = *found->second;
      text += fmt::format("{},{},{},{},{},{}", csv_escape(value.panel_uid), panel.row_number, panel.panel_number,
                          number_text(panel.length_m, ""), csv_escape(value.scan_id), csv_escape(value.scan_date));
      for (const MeasuredColumn& column : kMeasuredColumns)
        text.append(",").append(number_text(value.*column.value, ""));
      text += fmt::format(",{},{}", value.ray_count, csv_escape(value.wood_scan_id));
      text += descriptor_fields(value.descriptors) + "," + csv_escape(value.wood_from);
      text += place_fields(block, centres.at(value.panel_uid));
    }
  }
  return text;
}

Result<std::string> row_metres_csv(const BlockProducts& block, const std::string& path) {
  RAYFIELD_ASSIGN(const ToWgs84 to_wgs84, ToWgs84::create(block.crs, kCsvWhat, path));
  std::string text =
      "row_number,chainage_m,easting_m,northing_m,scan_id,scan_date,leaf_area_per_m,plant_area_per_m,canopy_height_m,"
      "canopy_width_m" +
      descriptor_names() + ",block,farm,variety,longitude,latitude\n";
  for (const ScanResults& scan : block.scans) {
    for (const RowMetreProduct& metre : scan.row_metres) {
      RAYFIELD_ASSIGN(const Eigen::Vector2d place,
                      to_wgs84.point(metre.position, fmt::format("a half metre of row {}", metre.row_number)));
      text += fmt::format("{},{},{},{},{},{},{},{}", metre.row_number, number_text(metre.chainage_m, ""),
                          number_text(metre.position.x(), ""), number_text(metre.position.y(), ""),
                          csv_escape(metre.scan_id), csv_escape(metre.scan_date),
                          number_text(metre.leaf_area_per_m, ""), number_text(metre.plant_area_per_m, ""));
      text += fmt::format(",{},{}", number_text(metre.canopy_height_m, ""), number_text(metre.canopy_width_m, ""));
      text += descriptor_fields(metre.descriptors);
      text += place_fields(block, place_text(place));
    }
  }
  return text;
}

// As the table panel_profile; panels that are not the block's are left out, as in the other files.
std::string panel_profile_csv(const BlockProducts& block) {
  std::string text =
      "panel_uid,row_number,panel_number,scan_id,scan_date,height_low_m,height_high_m,plant_area_m2,leaf_area_m2,"
      "block,farm,variety\n";
  const auto panels = panels_by_uid(block);
  for (const ScanResults& scan : block.scans)
    for (const PanelProfileBand& band : scan.profile) {
      const auto found = panels.find(band.panel_uid);
      if (found == panels.end()) continue;
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_escape(band.panel_uid), found->second->row_number,
                      found->second->panel_number, csv_escape(band.scan_id), csv_escape(band.scan_date),
                      number_text(band.height_low_m, ""), number_text(band.height_high_m, ""),
                      number_text(band.plant_area_m2, ""), number_text(band.leaf_area_m2, ""), csv_escape(block.block),
                      csv_escape(block.farm), csv_escape(block.variety));
    }
  return text;
}

template <class MakeText>
Result<void> write_csv(const std::string& path, const MakeText& make_text) {
  return guarded(kCsvWhat, path, [&]() -> Result<void> {
    const GdalSession gdal;
    RAYFIELD_ASSIGN(const std::string text, make_text());
    return write_file_atomically(path, text, kCsvWhat);
  });
}

}  // namespace

Result<void> check_panel_format(PanelFormat format, const std::string& path) {
  const auto [driver, what] = format_text(format, 0);
  return check_driver(driver, what, path);
}

Result<void> write_panels(const BlockProducts& block, std::size_t scan_index, PanelFormat format,
                          const std::string& path) {
  const auto [driver, what] = format_text(format, block.snapshot);
  return guarded(what, path, [&, &driver = driver, &what = what]() -> Result<void> {
    const GdalSession gdal;
    RAYFIELD_ASSIGN(const VectorTable table, panel_table(block, scan_index, what, path));
    RAYFIELD_ASSIGN(const std::vector<NamedBytes> files, vector_files(table, driver, "panels", what, path));
    return write_file_atomically(path, files.front().bytes, what);
  });
}

Result<void> write_panels_shapefile(const BlockProducts& block, std::size_t scan_index, const FarmProfile& profile,
                                    const std::string& path) {
  return guarded(kShapefileWhat, path, [&]() -> Result<void> {
    const GdalSession gdal;
    RAYFIELD_ASSIGN(VectorTable table, panel_table(block, scan_index, kShapefileWhat, path));
    const ScanProduct& scan = block.scans[scan_index].scan;
    return write_shapefile_zip(std::move(table), profile, fmt::format("{}_{}_panels", block.block, scan.scan_id),
                               scan.scan_date, path, kShapefileWhat);
  });
}

Result<void> write_panel_fields(const std::string& path) {
  return guarded(kCsvWhat, path,
                 [&] { return write_file_atomically(path, field_dictionary(panel_columns()), kCsvWhat); });
}

Result<void> write_panels_csv(const BlockProducts& block, const std::string& path) {
  return write_csv(path, [&] { return panels_csv(block, path); });
}

Result<void> write_row_metres_csv(const BlockProducts& block, const std::string& path) {
  return write_csv(path, [&] { return row_metres_csv(block, path); });
}

Result<void> write_panel_profile_csv(const BlockProducts& block, const std::string& path) {
  return write_csv(path, [&]() -> Result<std::string> { return panel_profile_csv(block); });
}

}  // namespace rayfield::formats
