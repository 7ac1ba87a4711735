#pragma once

#include <ogr_core.h>

#include <string>
#include <string_view>
#include <vector>

#include "rayfield/core/products.h"

/// Tables and columns of the GeoPackage: one place for types, titles and units.
namespace rayfield::formats::gpkg {

/// Opens every error message of the GeoPackage writer.
inline constexpr std::string_view kWhat = "cannot write GeoPackage";

struct Column {
  std::string name;
  OGRFieldType type = OFTString;
  std::string description;  ///< with the unit
};

struct Table {
  std::string name, description;
  OGRwkbGeometryType geometry = wkbNone;
  std::vector<Column> columns;
};

Table vine_row_table();
Table panel_table();
Table post_table();
Table block_table();
Table scan_table();
Table panel_value_table();
Table panel_profile_table();
Table row_metre_table();
/// One column `leaf_area_per_m_<date>` per scan, in the order of the scans.
Table panel_wide_table(const BlockProducts& block);
/// The columns that the view takes from `panel` and from `panel_value`.
Table panel_by_date_view();

/// Column of panel_wide that holds scan `index`; a second scan of one date gets a suffix.
std::string wide_column(const BlockProducts& block, std::size_t index);

}  // namespace rayfield::formats::gpkg
