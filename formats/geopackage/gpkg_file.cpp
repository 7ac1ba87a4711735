#include "formats/geopackage/gpkg_file.h"

#include <cpl_string.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "formats/io/staged_output.h"
#include "rayfield/core/date.h"

namespace rayfield::formats::gpkg {
namespace {

/// True for `YYYY-MM-DDThh:mm:ss.sssZ`, the only form that GeoPackage 1.2 takes for times.
bool is_utc_text(const std::string& text) {
  constexpr std::string_view kPattern = "0000-00-00T00:00:00.000Z";
  if (text.size() != kPattern.size()) return false;
  for (std::size_t i = 0; i < kPattern.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (kPattern[i] == '0' ? !digit : text[i] != kPattern[i]) return false;
  }
  return parse_date(text.substr(0, 10)).has_value();
}

Result<void> fill_new_file(GdalSession& gdal, OGRSpatialReference& crs, const FileContent& content,
                           const std::string& file, const std::string& target) {
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  if (driver == nullptr) return fail(ErrorCode::internal, kWhat, target, "GDAL lacks the GPKG driver");
  CPLStringList creation;
  creation.SetNameValue("VERSION", "1.2");
  DatasetPtr dataset(driver->Create(file.c_str(), 0, 0, 0, GDT_Unknown, creation.List()));
  if (dataset == nullptr) return gdal.failure(kWhat, target);
  dataset->StartTransaction();
  RAYFIELD_CHECK(content.fill({*dataset, gdal, crs, target}));
  if (dataset->CommitTransaction() != OGRERR_NONE) return gdal.failure(kWhat, target);
  dataset.reset();
  if (gdal.failed()) return gdal.failure(kWhat, target);
  return {};
}

Result<void> finish_file(GdalSession& gdal, OGRSpatialReference& crs, const FileContent& content,
                         const std::string& file, const std::string& target) {
  DatasetPtr dataset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE | GDAL_OF_VERBOSE_ERROR));
  if (dataset == nullptr) return gdal.failure(kWhat, target);
  dataset->StartTransaction();
  RAYFIELD_CHECK(content.finish({*dataset, gdal, crs, target}));
  if (dataset->CommitTransaction() != OGRERR_NONE) return gdal.failure(kWhat, target);
  dataset.reset();
  if (gdal.failed()) return gdal.failure(kWhat, target);
  return {};
}

/// Where what has just been written is not found any more, the disk did not read it, and GDAL takes the file for
/// another one.
Error read_back_failure(Error error) {
  constexpr std::array<std::string_view, 3> kSigns = {"not recognized as a supported file format",
                                                      "required GeoPackage tables", "already exists"};
  const bool lost = std::any_of(kSigns.begin(), kSigns.end(),
                                [&](std::string_view sign) { return error.why.find(sign) != std::string::npos; });
  if (error.code != ErrorCode::internal || !lost) return error;
  error.code = ErrorCode::resources;
  error.why = "what was just written cannot be read back (" + error.why + ")";
  error.next = "check the disk";
  return error;
}

}  // namespace

std::string time_of_change(std::span<const ScanProduct> scans) {
  std::string latest = "1970-01-01T00:00:00.000Z";
  for (const ScanProduct& scan : scans) {
    const std::string time = is_utc_text(scan.end_utc) ? scan.end_utc : scan.scan_date + "T00:00:00.000Z";
    if (is_utc_text(time) && time > latest) latest = time;
  }
  return latest;
}

Result<void> write_file(const FileContent& content, const std::string& path) {
  // Durability comes from the sync before the rename, so SQLite need not sync in between.
  GdalSession gdal({{"OGR_CURRENT_DATE", content.time}, {"OGR_SQLITE_SYNCHRONOUS", "OFF"}});
  RAYFIELD_ASSIGN(OGRSpatialReference crs, parse_crs(content.crs, kWhat, path));
  RAYFIELD_ASSIGN(const StagedOutput staged, StagedOutput::create(path, kWhat));
  const std::string file = staged.path("block.gpkg");
  Result<void> written = fill_new_file(gdal, crs, content, file, path);
  if (written) written = finish_file(gdal, crs, content, file, path);
  if (written) written = content.check(gdal, file);
  if (!written) return tl::unexpected(read_back_failure(std::move(written).error()));
  return staged.publish("block.gpkg");
}

}  // namespace rayfield::formats::gpkg
