#include "formats/geopackage/gpkg_project.h"

#include <cpl_conv.h>
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "formats/geopackage/gpkg_describe.h"
#include "formats/io/text_escape.h"
#include "formats/qgis/block_project.h"
#include "formats/qgis/qgz.h"

namespace rayfield::formats::gpkg {
namespace {

std::string to_hex(std::string_view bytes) {
  std::string text;
  text.reserve(2 * bytes.size());
  for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  return text;
}

Result<void> set_crs(const OpenGeoPackage& package, qgis::Project& project) {
  char* text = nullptr;
  const char* const format[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  const OGRErr failed = package.crs.exportToWkt(&text, format);
  const std::unique_ptr<char, decltype(&CPLFree)> wkt(text, CPLFree);
  if (failed != OGRERR_NONE || wkt == nullptr) return package.gdal.failure(kWhat, package.target);
  project.crs_wkt = wkt.get();
  const char* authority = package.crs.GetAuthorityName(nullptr);
  const char* code = package.crs.GetAuthorityCode(nullptr);
  if (authority != nullptr && code != nullptr) project.crs_code = fmt::format("{}:{}", authority, code);
  return {};
}

}  // namespace

std::string project_name(const std::string& block) {
  std::string name = clean_text(block);
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool kept = byte >= 0x80 || (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                      std::string_view(" -_.").find(c) != std::string_view::npos;
    if (!kept) c = '_';
  }
  return name;
}

Result<void> add_project(const OpenGeoPackage& package, const BlockProducts& block, const GeoPackageOptions& options,
                         const std::string& time) {
  const std::string file_name = std::filesystem::path(package.target).filename().string();
  qgis::Project project = qgis::block_project(block, options.panel_scale, options.maps, file_name);
  RAYFIELD_CHECK(set_crs(package, project));
  RAYFIELD_ASSIGN(const std::string archive,
                  qgis::qgz(package.gdal, qgis::project_xml(project), kWhat, package.target));
  RAYFIELD_CHECK(execute(package, kCreateProjectTable));
  // QGIS stores the archive as text of hexadecimal digits, and times without a zone.
  const std::string metadata = fmt::format(R"({{"last_modified_time": "{}", "last_modified_user": "rayfield" }})",
                                           time.substr(0, std::string_view("YYYY-MM-DDThh:mm:ss").size()));
  return execute(package, fmt::format("INSERT INTO qgis_projects (name, metadata, content) VALUES ({}, {}, '{}')",
                                      sql_literal(project_name(block.block)), sql_literal(metadata), to_hex(archive)));
}

}  // namespace rayfield::formats::gpkg
