#pragma once

#include <ogr_core.h>
#include <ogr_geometry.h>

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace rayfield::formats {

/// A column of a table that other software reads.
struct VectorColumn {
  std::string name;
  std::string short_name;         ///< of at most ten characters and unlike all others, for shapefiles
  OGRFieldType type = OFTString;  ///< OFTString, OFTInteger, OFTInteger64, OFTReal or OFTDate
  std::string unit, meaning;

  bool is_number() const { return type == OFTInteger || type == OFTInteger64 || type == OFTReal; }
};

/// Nothing is NULL, as is a number that is not finite. Dates are YYYY-MM-DD.
using VectorValue = std::variant<std::monostate, std::int64_t, double, std::string>;

struct VectorFeature {
  std::string label;                      ///< what people call it
  std::unique_ptr<OGRGeometry> geometry;  ///< longitude and latitude (WGS 84); may be missing
  std::vector<VectorValue> values;        ///< by column; columns beyond them are not set
  std::string fill = {};                  ///< "#rrggbb", where the format has colours
};

/// Features of one kind with their values, in no format yet.
struct VectorTable {
  std::string name;
  OGRwkbGeometryType geometry = wkbPolygon;
  std::vector<VectorColumn> columns;
  std::vector<VectorFeature> features;
};

}  // namespace rayfield::formats
