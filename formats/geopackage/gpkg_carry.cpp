#include "formats/geopackage/gpkg_carry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "formats/geopackage/gpkg_own.h"
#include "formats/geopackage/gpkg_project.h"
#include "formats/io/guard.h"
#include "formats/io/text_escape.h"
#include "rayfield/formats/geopackage.h"

namespace rayfield::formats {
namespace gpkg {
namespace {

using Names = std::vector<std::string>;

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

// The new file, with the old one attached as `old`.
class Carrier {
 public:
  Carrier(GDALDataset& dataset, GdalSession& gdal, const std::string& target)
      : dataset_(dataset), gdal_(gdal), target_(target) {}

  Result<void> run(const std::string& sql) const {
    OGRLayer* rows = dataset_.ExecuteSQL(sql.c_str(), nullptr, nullptr);
    if (rows != nullptr) dataset_.ReleaseResultSet(rows);
    if (gdal_.failed()) return gdal_.failure(kWhat, target_);
    return {};
  }
  Names old(const std::string& sql) const { return query(dataset_, sql); }

  // Rows of a table of GeoPackage's own, by the columns that both files have.
  Result<void> copy_rows(const std::string& table, const std::string& where, const Names& leave_out = {}) const {
    const Names here = columns("main", table), there = columns("old", table);
    Names both;
    for (const std::string& column : here)
      if (std::find(there.begin(), there.end(), column) != there.end() &&
          std::find(leave_out.begin(), leave_out.end(), column) == leave_out.end())
        both.push_back(quoted(column));
    if (both.empty()) return {};
    return run(fmt::format("INSERT OR IGNORE INTO main.{0} ({1}) SELECT {1} FROM old.{0} WHERE {2}", quoted(table),
                           fmt::join(both, ", "), where));
  }

  // A table with its rows, spatial indices, indices and triggers; triggers come last, so that they do not fire.
  Result<void> copy_table(const std::string& table) const {
    const std::string name = sql_literal(table);
    for (const std::string& sql : old("SELECT sql FROM old.sqlite_master WHERE type = 'table' AND name = " + name))
      RAYFIELD_CHECK(run(sql));
    RAYFIELD_CHECK(copy_rows(table, "1"));
    for (const std::string& column :
         old("SELECT column_name FROM old.gpkg_geometry_columns WHERE table_name = " + name)) {
      const std::string tree = fmt::format("rtree_{}_{}", table, column);
      const Names made = old("SELECT sql FROM old.sqlite_master WHERE name = " + sql_literal(tree));
      if (made.empty()) continue;
      RAYFIELD_CHECK(run(made.front()));
      RAYFIELD_CHECK(run(fmt::format("INSERT INTO main.{0} SELECT * FROM old.{0}", quoted(tree))));
    }
    RAYFIELD_CHECK(describe(table));
    for (const char* type : {"index", "trigger"})
      for (const std::string& sql : old(fmt::format(
               "SELECT sql FROM old.sqlite_master WHERE type = '{}' AND tbl_name = {} AND sql NOT NULL", type, name)))
        RAYFIELD_CHECK(run(sql));
    return {};
  }

  Result<void> copy_view(const std::string& view) const {
    for (const std::string& sql :
         old("SELECT sql FROM old.sqlite_master WHERE type = 'view' AND name = " + sql_literal(view)))
      RAYFIELD_CHECK(run(sql));
    return describe(view);
  }

  // A style that users made the default of a layer takes the place of ours.
  Result<void> copy_styles() const {
    const std::string theirs = "(owner IS NULL OR owner <> 'rayfield')";
    RAYFIELD_CHECK(
        run("UPDATE main.layer_styles SET useAsDefault = 0 WHERE f_table_name IN (SELECT f_table_name FROM "
            "old.layer_styles WHERE useAsDefault = 1 AND " +
            theirs + ")"));
    return copy_rows("layer_styles", theirs, {"id"});
  }

  // A project that users saved under the name of ours gets one that says when.
  Result<void> copy_projects() const {
    RAYFIELD_CHECK(run(kCreateProjectTable));
    // Without ':' and brackets, which QGIS does not always find again.
    const std::string time =
        "replace(replace(substr(CAST(metadata AS TEXT), instr(CAST(metadata AS TEXT), '_time\": \"') + 9, 19), 'T', ' "
        "'), "
        "':', '.')";
    return run(
        fmt::format("INSERT INTO main.{0} (name, metadata, content) SELECT CASE WHEN name IN "
                    "(SELECT name FROM main.{0}) THEN name || ' saved ' || ifnull({1}, 'by a user') ELSE name END, "
                    "metadata, content FROM old.{0} WHERE {2}",
                    kProjectTable, time, kProjectOfUsers));
  }

 private:
  Names columns(const char* file, const std::string& table) const {
    return old(fmt::format("SELECT name FROM pragma_table_info({}, '{}')", sql_literal(table), file));
  }
  // What GeoPackage says of a table.
  Result<void> describe(const std::string& table) const {
    const std::string where = "lower(table_name) = lower(" + sql_literal(table) + ")";
    for (const char* about :
         {"gpkg_contents", "gpkg_geometry_columns", "gpkg_ogr_contents", "gpkg_extensions", "gpkg_data_columns"})
      RAYFIELD_CHECK(copy_rows(about, where));
    return {};
  }

  GDALDataset& dataset_;
  GdalSession& gdal_;
  const std::string& target_;
};

Result<void> carry(const Carrier& carrier, const Additions& added) {
  for (const char* shared : {"gpkg_spatial_ref_sys", "gpkg_data_column_constraints"})
    RAYFIELD_CHECK(carrier.copy_rows(shared, "1"));
  for (const std::string& table : added.tables) RAYFIELD_CHECK(carrier.copy_table(table));
  for (const std::string& view : added.views) RAYFIELD_CHECK(carrier.copy_view(view));
  if (!added.styles.empty()) RAYFIELD_CHECK(carrier.copy_styles());
  if (!added.projects.empty()) RAYFIELD_CHECK(carrier.copy_projects());
  return {};
}

Result<void> check_counts(const Carrier& carrier, const Additions& added, const std::string& target) {
  bool good = carrier.old("PRAGMA main.integrity_check") == Names{"ok"};
  for (const std::string& table : added.tables)
    good = good && carrier.old("SELECT count(*) FROM main." + quoted(table)) ==
                       carrier.old("SELECT count(*) FROM old." + quoted(table));
  if (!added.projects.empty()) {
    const Names here =
        carrier.old(fmt::format("SELECT count(*) FROM main.{} WHERE {}", kProjectTable, kProjectOfUsers));
    good = good && here == Names{std::to_string(added.projects.size())};
  }
  if (good) return {};
  return fail(ErrorCode::internal, kWhat, target, "tables of users did not come over whole",
              "move the file, and report this");
}

}  // namespace

Result<void> carry_additions(const std::string& from, const std::string& to) {
  std::optional<Additions> added;
  {
    const GdalSession reading;
    const DatasetPtr old(GDALDataset::Open(from.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
    if (old != nullptr) added = additions_in(*old);
  }
  const std::vector<std::pair<std::string, std::string>> quick = {{"OGR_SQLITE_SYNCHRONOUS", "OFF"}};
  GdalSession gdal(quick);
  DatasetPtr dataset(GDALDataset::Open(to.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE | GDAL_OF_VERBOSE_ERROR));
  if (dataset == nullptr || gdal.failed()) return gdal.failure(kWhat, to);
  if (!added) return {};
  const Carrier carrier(*dataset, gdal, to);
  RAYFIELD_CHECK(carrier.run("ATTACH " + sql_literal(from) + " AS old"));
  dataset->StartTransaction();
  RAYFIELD_CHECK(carry(carrier, *added));
  if (dataset->CommitTransaction() != OGRERR_NONE) return gdal.failure(kWhat, to);
  RAYFIELD_CHECK(check_counts(carrier, *added, to));
  RAYFIELD_CHECK(carrier.run("DETACH old"));
  dataset.reset();
  if (gdal.failed()) return gdal.failure(kWhat, to);
  return {};
}

}  // namespace gpkg

Result<void> carry_over(const std::string& from, const std::string& to) {
  return guarded(gpkg::kWhat, to, [&] { return gpkg::carry_additions(from, to); });
}

}  // namespace rayfield::formats
