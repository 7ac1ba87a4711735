#include "rayfield/formats/geopackage.h"

#include <cpl_string.h>

#include "formats/gis/gdal_session.h"
#include "formats/gis/gpkg_finish.h"
#include "formats/gis/gpkg_layers.h"
#include "formats/io/guard.h"
#include "formats/io/staged_output.h"
#include "rayfield/core/date.h"

namespace rayfield::formats {
namespace {

using gpkg::kWhat;

/// True for `YYYY-MM-DDThh:mm:ss.sssZ`, the only form that GeoPackage 1.2 takes for times.
bool is_utc_text(const std::string& text) {
  constexpr std::string_view pattern = "0000-00-00T00:00:00.000Z";
  if (text.size() != pattern.size()) return false;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (pattern[i] == '0' ? !digit : text[i] != pattern[i]) return false;
  }
  return parse_date(text.substr(0, 10)).has_value();
}

/// The time of change that the file records: the end of the last scan, so that equal products are equal bytes.
std::string time_of_change(const BlockProducts& block) {
  std::string latest = "1970-01-01T00:00:00.000Z";
  for (const ScanResults& results : block.scans) {
    const ScanProduct& scan = results.scan;
    const std::string time = is_utc_text(scan.end_utc) ? scan.end_utc : scan.scan_date + "T00:00:00.000Z";
    if (is_utc_text(time) && time > latest) latest = time;
  }
  return latest;
}

Result<void> fill_new_file(GdalSession& gdal, OGRSpatialReference& crs, const BlockProducts& block,
                           const std::string& file, const std::string& target) {
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  if (driver == nullptr) return fail(ErrorCode::internal, kWhat, target, "GDAL lacks the GPKG driver");
  CPLStringList creation;
  creation.SetNameValue("VERSION", "1.2");
  DatasetPtr dataset(driver->Create(file.c_str(), 0, 0, 0, GDT_Unknown, creation.List()));
  if (dataset == nullptr) return gdal.failure(kWhat, target);
  const gpkg::OpenGeoPackage package{*dataset, gdal, crs, target};
  dataset->StartTransaction();
  RAYFIELD_CHECK(gpkg::fill_tables(package, block));
  if (dataset->CommitTransaction() != OGRERR_NONE) return gdal.failure(kWhat, target);
  dataset.reset();
  if (gdal.failed()) return gdal.failure(kWhat, target);
  return {};
}

/// In a second session, because GDAL writes extents and spatial indices when it closes the first.
Result<void> finish_file(GdalSession& gdal, OGRSpatialReference& crs, const BlockProducts& block,
                         const std::string& file, const std::string& target) {
  DatasetPtr dataset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE | GDAL_OF_VERBOSE_ERROR));
  if (dataset == nullptr) return gdal.failure(kWhat, target);
  const gpkg::OpenGeoPackage package{*dataset, gdal, crs, target};
  dataset->StartTransaction();
  RAYFIELD_CHECK(gpkg::finish(package, block, time_of_change(block)));
  if (dataset->CommitTransaction() != OGRERR_NONE) return gdal.failure(kWhat, target);
  dataset.reset();
  if (gdal.failed()) return gdal.failure(kWhat, target);
  return {};
}

Result<void> write_block(const BlockProducts& block, const std::string& path) {
  // Durability comes from the sync before the rename, so SQLite need not sync in between.
  GdalSession gdal({{"OGR_CURRENT_DATE", time_of_change(block)}, {"OGR_SQLITE_SYNCHRONOUS", "OFF"}});
  RAYFIELD_ASSIGN(OGRSpatialReference crs, parse_crs(block.crs, kWhat, path));
  RAYFIELD_ASSIGN(const StagedOutput staged, StagedOutput::create(path, kWhat));
  const std::string file = staged.path("block.gpkg");
  RAYFIELD_CHECK(fill_new_file(gdal, crs, block, file, path));
  RAYFIELD_CHECK(finish_file(gdal, crs, block, file, path));
  RAYFIELD_CHECK(gpkg::check_file(gdal, file, block, path));
  return staged.publish("block.gpkg");
}

}  // namespace

Result<void> write_geopackage(const BlockProducts& block, const std::string& path) {
  return guarded(kWhat, path, [&] { return write_block(block, path); });
}

}  // namespace rayfield::formats
