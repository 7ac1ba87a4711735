#pragma once

#include <ogrsf_frmts.h>

#include <string>
#include <vector>

namespace rayfield::formats::testing {

/// An open GeoPackage that answers questions in SQL.
class GeopackageReader {
 public:
  explicit GeopackageReader(const std::string& path) {
    GDALAllRegister();
    dataset_ = GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY);
  }
  ~GeopackageReader() { GDALClose(dataset_); }
  GeopackageReader(const GeopackageReader&) = delete;
  GeopackageReader& operator=(const GeopackageReader&) = delete;

  bool good() const { return dataset_ != nullptr; }
  OGRLayer* layer(const std::string& name) const { return dataset_->GetLayerByName(name.c_str()); }
  /// All rows of a query; NULL as "NULL".
  std::vector<std::vector<std::string>> rows(const std::string& sql) const {
    std::vector<std::vector<std::string>> all;
    OGRLayer* result = dataset_->ExecuteSQL(sql.c_str(), nullptr, nullptr);
    if (result == nullptr) return all;
    for (auto& feature : *result) {
      std::vector<std::string>& row = all.emplace_back();
      for (int i = 0; i < feature->GetFieldCount(); ++i) {
        row.push_back(feature->IsFieldSetAndNotNull(i) ? feature->GetFieldAsString(i) : "NULL");
      }
    }
    dataset_->ReleaseResultSet(result);
    return all;
  }
  std::string value(const std::string& sql) const {
    const auto all = rows(sql);
    return all.empty() || all[0].empty() ? "no row" : all[0][0];
  }
  std::vector<std::string> columns(const std::string& table) const {
    std::vector<std::string> names;
    for (const auto& row : rows("SELECT name FROM pragma_table_info('" + table + "')")) names.push_back(row[0]);
    return names;
  }

 private:
  GDALDataset* dataset_ = nullptr;
};

}  // namespace rayfield::formats::testing
