#include "rayfield/formats/stac.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "formats/gis/gdal_session.h"
#include "formats/io/guard.h"
#include "formats/io/staged_output.h"
#include "formats/io/text_escape.h"
#include "rayfield/core/date.h"

namespace rayfield::formats {
namespace {

using nlohmann::ordered_json;

constexpr std::string_view kWhat = "cannot write STAC";
constexpr const char* kStacVersion = "1.0.0";
constexpr const char* kCogType = "image/tiff; application=geotiff; profile=cloud-optimized";
constexpr double kDecimals = 1e7;  ///< of a degree: a centimetre

/// A reference to a file in the same folder: what RFC 3986 does not let stand for itself is written as %XX.
std::string reference(const std::string& file_name) {
  std::string text = "./";
  for (const char c : file_name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       std::string_view("-._~").find(c) != std::string_view::npos;
    text += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return text;
}

ordered_json link(const char* relation, const std::string& file_name, const char* type) {
  return {{"rel", relation}, {"href", reference(file_name)}, {"type", type}};
}

/// First and last moment of a scan.
struct Times {
  std::string start, end;
};

Result<Times> times_of(const ScanProduct& scan) {
  RAYFIELD_ASSIGN(const std::string date, parse_date(scan.scan_date));
  const bool known = scan.start_utc.ends_with("Z") && scan.end_utc.ends_with("Z") && scan.start_utc <= scan.end_utc;
  if (!known) return Times{date + "T00:00:00Z", date + "T23:59:59Z"};
  return Times{scan.start_utc, scan.end_utc};
}

/// The outline of all assets, south-west corner first, counter-clockwise, in longitude and latitude.
Result<std::array<Eigen::Vector2d, 4>> outline(const BlockProducts& block, const StacItem& item,
                                               const std::string& path) {
  if (item.assets.empty()) return fail(ErrorCode::usage, kWhat, path, "a scan without maps", "export GeoTIFFs too");
  RAYFIELD_ASSIGN(const OGRSpatialReference crs, parse_crs(block.crs, kWhat, path));
  OGRSpatialReference wgs84;
  wgs84.importFromEPSG(4326);
  wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  Eigen::AlignedBox2d box;
  for (const StacAsset& asset : item.assets) {
    box.extend(asset.origin);
    box.extend(asset.origin + asset.cell_m * Eigen::Vector2d(asset.nx, asset.ny));
  }
  double x[] = {box.min().x(), box.max().x(), box.max().x(), box.min().x()};
  double y[] = {box.min().y(), box.min().y(), box.max().y(), box.max().y()};
  const std::unique_ptr<OGRCoordinateTransformation> to_wgs84(OGRCreateCoordinateTransformation(&crs, &wgs84));
  if (to_wgs84 == nullptr || to_wgs84->Transform(4, x, y) == FALSE)
    return fail(ErrorCode::internal, kWhat, path, "its outline has no longitude and latitude");
  std::array<Eigen::Vector2d, 4> corners;
  for (std::size_t i = 0; i < corners.size(); ++i)
    corners[i] = {std::round(x[i] * kDecimals) / kDecimals, std::round(y[i] * kDecimals) / kDecimals};
  return corners;
}

Eigen::AlignedBox2d box_of(const std::array<Eigen::Vector2d, 4>& corners) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : corners) box.extend(corner);
  return box;
}

ordered_json json(const Eigen::AlignedBox2d& box) {
  return {box.min().x(), box.min().y(), box.max().x(), box.max().y()};
}

ordered_json asset_json(const StacAsset& asset) {
  const double north = asset.origin.y() + asset.ny * asset.cell_m;
  const ordered_json band = {{"data_type", "float32"},
                             {"nodata", "nan"},
                             {"unit", clean_text(asset.unit)},
                             {"sampling", "area"},
                             {"spatial_resolution", asset.cell_m}};
  return {{"href", reference(asset.file_name)},
          {"type", kCogType},
          {"title", clean_text(asset.description.empty() ? asset.product : asset.description)},
          {"roles", {"data"}},
          {"proj:shape", {asset.ny, asset.nx}},
          {"proj:transform", {asset.cell_m, 0.0, asset.origin.x(), 0.0, -asset.cell_m, north}},
          {"raster:bands", ordered_json::array({band})}};
}

/// `proj:epsg` is null for systems without a code; those are given as PROJJSON.
Result<void> add_crs(const BlockProducts& block, const std::string& path, ordered_json& properties) {
  RAYFIELD_ASSIGN(const OGRSpatialReference crs, parse_crs(block.crs, kWhat, path));
  const char* authority = crs.GetAuthorityName(nullptr);
  const char* code = crs.GetAuthorityCode(nullptr);
  if (authority != nullptr && code != nullptr && std::string_view(authority) == "EPSG") {
    properties["proj:epsg"] = std::stoi(code);
    return {};
  }
  char* text = nullptr;
  const OGRErr failed = crs.exportToPROJJSON(&text, nullptr);
  const std::unique_ptr<char, decltype(&CPLFree)> projjson(text, CPLFree);
  if (failed != OGRERR_NONE || projjson == nullptr)
    return fail(ErrorCode::internal, kWhat, path, "the coordinate reference system has no PROJJSON");
  properties["proj:epsg"] = nullptr;
  properties["proj:projjson"] = ordered_json::parse(projjson.get());
  return {};
}

// A STAC Item: one scan with its maps as assets.
Result<std::string> item_text(const BlockProducts& block, const StacItem& item, const std::string& collection_file,
                              const std::string& path) {
  const GdalSession gdal;
  RAYFIELD_ASSIGN(const auto corners, outline(block, item, path));
  RAYFIELD_ASSIGN(const Times times, times_of(item.scan));
  const std::string name = item.scan.name.empty() ? item.scan.scan_date : item.scan.scan_date + ", " + item.scan.name;
  ordered_json ring = ordered_json::array();
  for (std::size_t i = 0; i <= corners.size(); ++i)
    ring.push_back({corners[i % corners.size()].x(), corners[i % corners.size()].y()});
  ordered_json properties = {{"title", clean_text(block.block + ", " + name)},
                             {"datetime", times.start},
                             {"start_datetime", times.start},
                             {"end_datetime", times.end}};
  RAYFIELD_CHECK(add_crs(block, path, properties));
  ordered_json assets = ordered_json::object();
  for (const StacAsset& asset : item.assets) assets[clean_text(asset.product)] = asset_json(asset);
  const ordered_json document = {
      {"type", "Feature"},
      {"stac_version", kStacVersion},
      {"stac_extensions",
       {"https://stac-extensions.github.io/projection/v1.1.0/schema.json",
        "https://stac-extensions.github.io/raster/v1.1.0/schema.json"}},
      {"id", clean_text(block.block + "_" + item.scan.scan_id)},
      {"collection", clean_text(block.block)},
      {"geometry", {{"type", "Polygon"}, {"coordinates", ordered_json::array({ring})}}},
      {"bbox", json(box_of(corners))},
      {"properties", properties},
      {"links",
       {link("root", collection_file, "application/json"), link("parent", collection_file, "application/json"),
        link("collection", collection_file, "application/json")}},
      {"assets", assets}};
  return document.dump(1) + "\n";
}

// The Collection of all Items, with their joint extent in space and time.
Result<std::string> collection_text(const BlockProducts& block, std::span<const StacItem> items,
                                    const std::string& path) {
  const GdalSession gdal;
  if (items.empty()) return fail(ErrorCode::usage, kWhat, path, "a block without maps", "export GeoTIFFs too");
  Eigen::AlignedBox2d box;
  Times times;
  ordered_json links =
      ordered_json::array({link("root", std::filesystem::path(path).filename().string(), "application/json")});
  for (const StacItem& item : items) {
    RAYFIELD_ASSIGN(const auto corners, outline(block, item, path));
    box.extend(box_of(corners));
    RAYFIELD_ASSIGN(const Times of, times_of(item.scan));
    times.start = times.start.empty() ? of.start : std::min(times.start, of.start);
    times.end = std::max(times.end, of.end);
    links.push_back(link("item", item.file_name, "application/geo+json"));
  }
  std::string description = "Canopy maps of the block " + block.block;
  if (!block.farm.empty()) description += ", " + block.farm;
  if (!block.variety.empty()) description += ", " + block.variety;
  const ordered_json document = {
      {"type", "Collection"},
      {"stac_version", kStacVersion},
      {"id", clean_text(block.block)},
      {"title", clean_text(block.block)},
      {"description", clean_text(description + ", made by rayfield from lidar drives.")},
      {"license", "proprietary"},
      {"extent",
       {{"spatial", {{"bbox", ordered_json::array({json(box)})}}},
        {"temporal", {{"interval", ordered_json::array({ordered_json::array({times.start, times.end})})}}}}},
      {"links", links}};
  return document.dump(1) + "\n";
}

}  // namespace

Result<void> write_stac_item(const BlockProducts& block, const StacItem& item, const std::string& collection_file,
                             const std::string& path) {
  return guarded(kWhat, path, [&]() -> Result<void> {
    RAYFIELD_ASSIGN(const std::string text, item_text(block, item, collection_file, path));
    return write_file_atomically(path, text, kWhat);
  });
}

Result<void> write_stac_collection(const BlockProducts& block, std::span<const StacItem> items,
                                   const std::string& path) {
  return guarded(kWhat, path, [&]() -> Result<void> {
    RAYFIELD_ASSIGN(const std::string text, collection_text(block, items, path));
    return write_file_atomically(path, text, kWhat);
  });
}

}  // namespace rayfield::formats
