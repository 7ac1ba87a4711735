#include "rayfield/formats/geopackage.h"

#include <vector>

#include "formats/geopackage/gpkg_file.h"
#include "formats/geopackage/gpkg_finish.h"
#include "formats/geopackage/gpkg_layers.h"
#include "formats/io/guard.h"

namespace rayfield::formats {
namespace {

using gpkg::kWhat;

Result<void> write_block(const BlockProducts& block, const std::string& path, const GeoPackageOptions& options) {
  std::vector<ScanProduct> scans;
  for (const ScanResults& results : block.scans) scans.push_back(results.scan);
  const std::string time = gpkg::time_of_change(scans);
  return gpkg::write_file(
      {block.crs, time, [&](const gpkg::OpenGeoPackage& package) { return gpkg::fill_tables(package, block); },
       [&](const gpkg::OpenGeoPackage& package) { return gpkg::finish(package, block, options, time); },
       [&](GdalSession& gdal, const std::string& file) { return gpkg::check_file(gdal, file, block, path); }},
      path);
}

}  // namespace

Result<void> write_geopackage(const BlockProducts& block, const std::string& path, const GeoPackageOptions& options) {
  return guarded(kWhat, path, [&] { return write_block(block, path, options); });
}

}  // namespace rayfield::formats
