#include "formats/exchange/shapefile_zip.h"

#include <fmt/format.h>

#include <vector>

#include "formats/exchange/panel_table.h"
#include "formats/gis/vector_file.h"
#include "formats/io/zip_file.h"

namespace rayfield::formats {
namespace {

/// Letters, digits, '-' and '_': what every program and file system takes.
std::string ascii_name(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    const bool good = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-';
    if (good || plain.empty() || plain.back() != '_') plain.push_back(good ? c : '_');
  }
  return plain;
}

Result<void> check_fits(const VectorTable& table, const FarmProfile& profile, const std::string& path,
                        std::string_view what) {
  if (profile.most_features == 0 || table.features.size() <= profile.most_features) return {};
  return fail(ErrorCode::usage, what, path,
              fmt::format("{} polygons, and {} takes {}", table.features.size(), profile.name, profile.most_features),
              "give it zones: see `rayfield zones`");
}

}  // namespace

Result<void> write_shapefile_zip(VectorTable table, const FarmProfile& profile, const std::string& stem,
                                 const std::string& date, const std::string& path, std::string_view what) {
  RAYFIELD_CHECK(check_fits(table, profile, path, what));
  table = reduced_for(std::move(table), profile);
  const std::string name = ascii_name(stem);
  RAYFIELD_ASSIGN(std::vector<NamedBytes> files, vector_files(table, shapefile_format(date), name, what, path));
  if (!profile.projection_files)
    std::erase_if(files, [](const NamedBytes& f) { return f.name.ends_with(".prj") || f.name.ends_with(".cpg"); });
  if (profile.field_dictionary) files.push_back({name + "_fields.csv", field_dictionary(table.columns)});
  std::vector<ZipMember> members;
  for (const NamedBytes& file : files) members.push_back({std::string(profile.folder) + file.name, file.bytes});
  return write_zip(members, date, path, what);
}

}  // namespace rayfield::formats
