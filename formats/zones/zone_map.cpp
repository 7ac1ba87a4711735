#include "rayfield/formats/zone_map.h"

#include <fmt/format.h>

#include <array>

#include "formats/exchange/shapefile_zip.h"
#include "formats/geopackage/gpkg_describe.h"
#include "formats/geopackage/gpkg_file.h"
#include "formats/geopackage/gpkg_row.h"
#include "formats/gis/qml.h"
#include "formats/gis/to_wgs84.h"
#include "formats/gis/vector_file.h"
#include "formats/io/guard.h"
#include "formats/io/staged_output.h"
#include "formats/zones/zone_table.h"

namespace rayfield::formats {
namespace {

constexpr std::string_view kWhat = "cannot write zones";

gpkg::Table layer_table(const VectorTable& table) {
  gpkg::Table layer{table.name, "Management zones of a block", table.geometry, {}};
  for (const VectorColumn& column : table.columns)
    layer.columns.push_back(
        {column.name, column.type,
         column.unit.empty() ? column.meaning : fmt::format("{}, {}", column.meaning, column.unit)});
  return layer;
}

Result<void> fill_layer(const gpkg::OpenGeoPackage& package, const VectorTable& table) {
  RAYFIELD_ASSIGN(OGRLayer * layer, gpkg::create_table(package, layer_table(table)));
  for (const VectorFeature& feature : table.features) {
    gpkg::Row out(*layer);
    for (std::size_t i = 0; i < feature.values.size(); ++i) {
      const VectorValue& value = feature.values[i];
      if (const auto* text = std::get_if<std::string>(&value))
        table.columns[i].type == OFTDate ? out.date(*text) : out.text(*text);
      else if (const auto* integer = std::get_if<std::int64_t>(&value))
        out.integer(*integer);
      else if (const auto* real = std::get_if<double>(&value))
        out.real(*real);
      else
        out.optional_text("");
    }
    out.geometry(*feature.geometry);
    RAYFIELD_CHECK(gpkg::check_written(package, out.write()));
  }
  return {};
}

std::string zone_style(const ZoneMap& map) {
  std::vector<qml::Category> categories;
  for (const ManagementZone& zone : map.zones)
    categories.push_back({zone.zone,
                          fmt::format("zone {}, mean {:.2f} {}", zone.zone, zone.mean, pretty_unit(map.unit)),
                          zone_color(map, zone.zone)});
  return qml::document(qml::category_style("zone", categories));
}

Result<void> finish_layer(const gpkg::OpenGeoPackage& package, const VectorTable& table, const ZoneMap& map,
                          const std::string& time) {
  const std::array<gpkg::Table, 1> tables = {layer_table(table)};
  RAYFIELD_CHECK(gpkg::describe_tables(package, tables));
  const std::array<gpkg::Style, 1> styles = {{{table.name, "zone", zone_style(map)}}};
  return gpkg::add_layer_styles(package, styles, time);
}

Result<void> check_layer(GdalSession& gdal, const std::string& file, const VectorTable& table,
                         const std::string& target) {
  const DatasetPtr dataset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
  OGRLayer* layer = dataset == nullptr ? nullptr : dataset->GetLayerByName(table.name.c_str());
  const bool good = layer != nullptr && layer->GetFeatureCount() == static_cast<GIntBig>(table.features.size());
  if (gdal.failed()) return gdal.failure(kWhat, target);
  if (good) return {};
  return fail(ErrorCode::resources, kWhat, target, "the file reads back other zones than were written",
              "check the disk");
}

/// The zones in longitude and latitude.
Result<VectorTable> wgs84_table(const ZoneMap& map, const std::optional<Prescription>& rates, const std::string& path) {
  RAYFIELD_ASSIGN(const ToWgs84 to_wgs84, ToWgs84::create(map.crs, kWhat, path));
  VectorTable table = zone_table(map, rates);
  for (VectorFeature& feature : table.features) RAYFIELD_CHECK(to_wgs84.move(*feature.geometry, feature.label));
  return table;
}

}  // namespace

Result<void> write_zones_geopackage(const ZoneMap& map, const std::string& path) {
  return guarded(kWhat, path, [&]() -> Result<void> {
    const VectorTable table = zone_table(map, {});
    const std::array<ScanProduct, 1> scans = {map.scan};
    const std::string time = gpkg::time_of_change(scans);
    return gpkg::write_file(
        {map.crs, time, [&](const gpkg::OpenGeoPackage& package) { return fill_layer(package, table); },
         [&](const gpkg::OpenGeoPackage& package) { return finish_layer(package, table, map, time); },
         [&](GdalSession& gdal, const std::string& file) { return check_layer(gdal, file, table, path); }},
        path);
  });
}

Result<void> write_zones_geojson(const ZoneMap& map, const std::string& path) {
  return guarded(kWhat, path, [&]() -> Result<void> {
    const GdalSession gdal;
    RAYFIELD_ASSIGN(const VectorTable table, wgs84_table(map, {}, path));
    RAYFIELD_ASSIGN(const std::vector<NamedBytes> files,
                    vector_files(table, geojson_format(map.snapshot, ""), "zones", kWhat, path));
    return write_file_atomically(path, files.front().bytes, kWhat);
  });
}

Result<void> write_zones_shapefile(const ZoneMap& map, const std::optional<Prescription>& rates,
                                   const FarmProfile& profile, const std::string& path) {
  return guarded(kWhat, path, [&]() -> Result<void> {
    const GdalSession gdal;
    RAYFIELD_ASSIGN(VectorTable table, wgs84_table(map, rates, path));
    const std::string stem =
        fmt::format("{}_{}_{}", map.block, map.scan.scan_id, rates.has_value() ? "prescription" : "zones");
    return write_shapefile_zip(std::move(table), profile, stem, map.scan.scan_date, path, kWhat);
  });
}

}  // namespace rayfield::formats
