#include "formats/geopackage/gpkg_own.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "formats/geopackage/gpkg_project.h"
#include "formats/io/guard.h"
#include "formats/io/text_escape.h"
#include "rayfield/formats/geopackage.h"

namespace rayfield::formats {
namespace gpkg {

std::vector<std::string> query(GDALDataset& dataset, const std::string& sql) {
  std::vector<std::string> values;
  OGRLayer* rows = dataset.ExecuteSQL(sql.c_str(), nullptr, nullptr);
  if (rows == nullptr) return values;
  for (auto& row : *rows) values.emplace_back(row->GetFieldCount() > 0 ? row->GetFieldAsString(0) : "");
  dataset.ReleaseResultSet(rows);
  return values;
}

}  // namespace gpkg

namespace {

using gpkg::Additions;
using gpkg::query;
using Names = std::vector<std::string>;
using Tables = std::map<std::string, Names>;  // columns by table

constexpr const char* kTablesItem = "rayfield_tables";
constexpr const char* kOwner = "rayfield";

// Tables of SQLite, of GeoPackage and of R-trees come and go with the tables that people see; projects are told apart
// one by one.
bool is_bookkeeping(const std::string& table) {
  return table.starts_with("sqlite_") || table.starts_with("gpkg_") || table.starts_with("rtree_");
}

Tables tables_in(GDALDataset& dataset) {
  Tables tables;
  for (const std::string& table : query(dataset, "SELECT name FROM sqlite_master WHERE type IN ('table', 'view')")) {
    if (is_bookkeeping(table) || table == gpkg::kProjectTable) continue;
    tables[table] = query(dataset, "SELECT name FROM pragma_table_info(" + sql_literal(table) + ")");
  }
  return tables;
}

// "panel(fid,geom,panel_uid);post(fid,geom)": names of ours hold none of these characters.
std::string to_text(const Tables& tables) {
  std::string text;
  for (const auto& [table, columns] : tables)
    text += fmt::format("{}{}({})", text.empty() ? "" : ";", table, fmt::join(columns, ","));
  return text;
}

Names split(std::string_view text, char at) {
  Names parts;
  while (!text.empty()) {
    parts.emplace_back(text.substr(0, text.find(at)));
    text.remove_prefix(std::min(parts.back().size() + 1, text.size()));
  }
  return parts;
}

Tables from_text(std::string_view text) {
  Tables tables;
  for (const std::string& entry : split(text, ';')) {
    const std::size_t open = std::min(entry.find('('), entry.size());
    const std::string columns = entry.substr(std::min(open + 1, entry.size()));
    tables[entry.substr(0, open)] = split(columns.substr(0, columns.find(')')), ',');
  }
  return tables;
}

// Files from before the record was kept: the tables that there were, and the columns that the file describes.
Tables own_tables_of_old_file(GDALDataset& dataset, const Tables& present) {
  static const std::array<const char*, 9> kTables = {
      "vine_row", "panel", "post", "scan", "panel_value", "row_metre", "panel_by_date", "panel_wide", "layer_styles"};
  Tables own;
  for (const char* table : kTables) {
    Names columns =
        query(dataset, "SELECT column_name FROM gpkg_data_columns WHERE table_name = " + sql_literal(table));
    columns.insert(columns.end(), {"fid", "geom", "OGC_FID"});
    const auto found = present.find(table);
    if (std::string_view(table) == "layer_styles" && found != present.end()) columns = found->second;
    own[table] = std::move(columns);
  }
  return own;
}

Names views_in(GDALDataset& dataset) { return query(dataset, "SELECT name FROM sqlite_master WHERE type = 'view'"); }

bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// What of `present` is not in `own`.
Additions not_own(const Tables& present, const Tables& own, const Names& views) {
  Additions added;
  for (const auto& [table, columns] : present) {
    const auto ours = own.find(table);
    if (ours == own.end()) {
      (contains(views, table) ? added.views : added.tables).push_back(table);
      continue;
    }
    for (const std::string& column : columns)
      if (!contains(ours->second, column))
        added.columns.push_back(fmt::format("column '{}' of table '{}'", column, table));
  }
  return added;
}

bool is_ours(GDALDataset& dataset, const Tables& present) {
  if (dataset.GetMetadataItem(kTablesItem) != nullptr) return true;
  return present.contains("panel_value") && present.contains("scan") &&
         !query(dataset, fmt::format("SELECT 1 FROM layer_styles WHERE owner = '{}' LIMIT 1", kOwner)).empty();
}

Result<std::optional<ExistingGeoPackage>> inspect(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  GdalSession gdal;
  DatasetPtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
  ExistingGeoPackage existing;
  const auto added = dataset == nullptr ? std::nullopt : gpkg::additions_in(*dataset);
  if (!added) {
    existing.lost.emplace_back("the whole file, which rayfield has not written");
    return existing;
  }
  existing.lost = added->columns;
  existing.has_additions =
      !added->tables.empty() || !added->views.empty() || !added->styles.empty() || !added->projects.empty();
  existing.scan_ids = query(*dataset, "SELECT scan_id FROM scan ORDER BY scan_date, scan_id");
  return existing;
}

}  // namespace

namespace gpkg {

std::optional<Additions> additions_in(GDALDataset& dataset) {
  const Tables present = tables_in(dataset);
  if (!is_ours(dataset, present)) return std::nullopt;
  const char* record = dataset.GetMetadataItem(kTablesItem);
  Additions added = not_own(present, record == nullptr ? own_tables_of_old_file(dataset, present) : from_text(record),
                            views_in(dataset));
  added.styles =
      query(dataset, fmt::format("SELECT styleName FROM layer_styles WHERE owner IS NULL OR owner <> '{}'", kOwner));
  added.projects = query(dataset, fmt::format("SELECT name FROM {} WHERE {}", kProjectTable, kProjectOfUsers));
  return added;
}

Result<void> add_metadata(const OpenGeoPackage& package, const BlockProducts& block) {
  Tables tables = tables_in(package.dataset);
  const bool good = package.dataset.SetMetadataItem("snapshot", std::to_string(block.snapshot).c_str()) == CE_None &&
                    package.dataset.SetMetadataItem(kTablesItem, to_text(tables).c_str()) == CE_None;
  if (!good || package.gdal.failed()) return package.gdal.failure(kWhat, package.target);
  return {};
}

}  // namespace gpkg

Result<void> check_not_in_use(const std::string& path) {
  for (const char* journal : {"-wal", "-journal"}) {
    std::error_code error;
    if (std::filesystem::file_size(path + journal, error) > 0 && !error)
      return fail(ErrorCode::usage, "cannot replace GeoPackage", path,
                  fmt::format("another program writes to it ({}{} is there)",
                              std::filesystem::path(path).filename().string(), journal),
                  "close it there, in QGIS the project, and run the same command again");
  }
  return {};
}

Result<std::optional<ExistingGeoPackage>> inspect_geopackage(const std::string& path) {
  return guarded("cannot read GeoPackage", path, [&] { return inspect(path); });
}

Result<void> check_replaceable(const BlockProducts& block, const std::vector<std::string>& scans_of_store,
                               const std::string& path) {
  RAYFIELD_CHECK(check_not_in_use(path));
  RAYFIELD_ASSIGN(const auto existing, inspect_geopackage(path));
  if (!existing) return {};
  if (!existing->lost.empty())
    return fail(ErrorCode::usage, "cannot replace GeoPackage", path,
                fmt::format("it holds what rayfield did not put there: {}", fmt::join(existing->lost, ", ")),
                "move it, give another -o, or lose that with --overwrite");
  std::set<std::string> kept_back(scans_of_store.begin(), scans_of_store.end());
  for (const ScanResults& results : block.scans) kept_back.erase(results.scan.scan_id);
  Names left_out;
  for (const std::string& id : existing->scan_ids)
    if (kept_back.contains(id)) left_out.push_back(id);
  if (left_out.empty()) return {};
  return fail(ErrorCode::usage, "cannot replace GeoPackage", path,
              fmt::format("it holds scans that this export leaves out: {}", fmt::join(left_out, ", ")),
              "leave --date out, give another -o, or --overwrite");
}

}  // namespace rayfield::formats
