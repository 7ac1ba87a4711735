#include "formats/qgis/qgz.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <fmt/format.h>

#include <limits>

namespace rayfield::formats::qgis {
namespace {

/// Fills a new archive at `path`; false where GDAL failed.
bool fill_archive(const std::string& path, std::string_view content) {
  void* archive = CPLCreateZip(path.c_str(), nullptr);
  if (archive == nullptr) return false;
  // GDAL 3.7 and later would note the time of writing.
  CPLStringList options;
  options.SetNameValue("TIMESTAMP", "315532800");
  bool good = content.size() <= std::numeric_limits<int>::max() &&
              CPLCreateFileInZip(archive, "project.qgs", options.List()) == CE_None;
  good = good && CPLWriteFileInZip(archive, content.data(), static_cast<int>(content.size())) == CE_None;
  good = good && CPLCloseFileInZip(archive) == CE_None;
  return CPLCloseZip(archive) == CE_None && good;
}

}  // namespace

Result<std::string> qgz(const GdalSession& gdal, std::string_view project_xml, std::string_view what,
                        std::string_view where) {
  // In memory; the address keeps writers in several threads apart.
  const std::string path = fmt::format("/vsimem/rayfield-{}.zip", static_cast<const void*>(project_xml.data()));
  const bool good = fill_archive(path, project_xml);
  vsi_l_offset size = 0;
  const GByte* bytes = VSIGetMemFileBuffer(path.c_str(), &size, FALSE);
  const std::string archive(reinterpret_cast<const char*>(bytes),
                            bytes == nullptr ? 0 : static_cast<std::size_t>(size));
  VSIUnlink(path.c_str());
  if (!good || archive.empty()) return gdal.failure(what, where);
  return archive;
}

}  // namespace rayfield::formats::qgis
