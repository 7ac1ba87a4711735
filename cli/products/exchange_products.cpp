#include "cli/products/exchange_products.h"

#include <fmt/core.h>

#include <array>

#include "rayfield/formats/exchange.h"

namespace rayfield::cli {
namespace {

// A format with one file of polygons per scan.
struct PanelFile {
  const char* name;
  const char* extension;
  formats::PanelFormat format;
};
constexpr std::array<PanelFile, 4> kPanelFiles = {{
    {"geojson", ".geojson", formats::PanelFormat::geojson},
    {"kml", ".kml", formats::PanelFormat::kml},
    {"flatgeobuf", ".fgb", formats::PanelFormat::flatgeobuf},
    {"geoparquet", ".parquet", formats::PanelFormat::geoparquet},
}};

// Shapefiles of one scan: the plain one, and one for each farm system.
Result<void> export_shapefiles(const BlockProducts& block, std::size_t scan, const std::string& content,
                               const ExportOptions& options, ExportFolder& folder) {
  const std::string stem = fmt::format("{}_{}", block.block, block.scans[scan].scan.scan_id);
  if (const std::string name = stem + "_panels.shp.zip";
      options.formats.count("shp") > 0 && folder.wants(name, content))
    RAYFIELD_CHECK(
        formats::write_panels_shapefile(block, scan, *formats::find_farm_profile("plain"), folder.path(name)));
  for (const std::string& profile : options.profiles)
    if (const std::string name = fmt::format("{}_{}.zip", stem, profile); folder.wants(name, content))
      RAYFIELD_CHECK(
          formats::write_panels_shapefile(block, scan, *formats::find_farm_profile(profile), folder.path(name)));
  return {};
}

}  // namespace

std::vector<std::string> export_formats() {
  return {"geotiff", "geotiff-plain", "gpkg",       "png",        "svg", "geojson", "csv",
          "shp",     "kml",           "flatgeobuf", "geoparquet", "ply", "las"};
}

std::vector<std::string> profile_names() {
  std::vector<std::string> names;
  for (const formats::FarmProfile& profile : formats::farm_profiles()) names.emplace_back(profile.name);
  return names;
}

Result<void> check_exchange(const ExportOptions& options) {
  for (const PanelFile& file : kPanelFiles)
    if (options.formats.count(file.name) > 0) RAYFIELD_CHECK(formats::check_panel_format(file.format, file.name));
  for (const std::string& profile : options.profiles)
    if (formats::find_farm_profile(profile) == nullptr)
      return fail(ErrorCode::usage, "cannot export", profile, "no such profile", "see `rayfield export --help`");
  return {};
}

Result<void> export_exchange(const BlockProducts& block, const std::string& content, const ExportOptions& options,
                             ExportFolder& folder) {
  const bool csv = options.formats.count("csv") > 0;
  if (const std::string name = block.block + "_panels.csv"; csv && folder.wants(name, content))
    RAYFIELD_CHECK(formats::write_panels_csv(block, folder.path(name)));
  if (const std::string name = block.block + "_row_metres.csv"; csv && folder.wants(name, content))
    RAYFIELD_CHECK(formats::write_row_metres_csv(block, folder.path(name)));
  if (const std::string name = block.block + "_panel_profile.csv"; csv && folder.wants(name, content))
    RAYFIELD_CHECK(formats::write_panel_profile_csv(block, folder.path(name)));
  const bool shapefiles = options.formats.count("shp") > 0 || !options.profiles.empty();
  if (const std::string name = block.block + "_fields.csv"; shapefiles && folder.wants(name, content))
    RAYFIELD_CHECK(formats::write_panel_fields(folder.path(name)));
  for (std::size_t i = 0; i < block.scans.size(); ++i) {
    for (const PanelFile& file : kPanelFiles)
      if (const std::string name =
              fmt::format("{}_{}_panels{}", block.block, block.scans[i].scan.scan_id, file.extension);
          options.formats.count(file.name) > 0 && folder.wants(name, content))
        RAYFIELD_CHECK(formats::write_panels(block, i, file.format, folder.path(name)));
    RAYFIELD_CHECK(export_shapefiles(block, i, content, options, folder));
  }
  return {};
}

}  // namespace rayfield::cli
