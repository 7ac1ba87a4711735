#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "formats/gis/gdal_session.h"
#include "formats/gis/vector_table.h"
#include "rayfield/core/result.h"

namespace rayfield::formats {

/// How one of GDAL's drivers is to write a table.
struct VectorFormat {
  const char* driver;     ///< GDAL's name of it
  const char* extension;  ///< of the file, with the dot
  std::vector<std::string> layer_options = {};
  bool dates_as_text = false;   ///< the format has no dates, or its driver writes them in a form of its own
  bool values_as_json = false;  ///< else GDAL rounds numbers, and takes text in braces for JSON
  bool places_only = false;     ///< the driver leaves out features without a geometry
  std::string id_column = {};   ///< column that is also written as "id", for GeoJSON
  std::string name_field = {}, fill_opacity = {};  ///< field that takes the label; hexadecimal, for KML's colours
};

VectorFormat geojson_format(std::uint64_t snapshot, const std::string& id_column);
VectorFormat kml_format();
VectorFormat flatgeobuf_format();
VectorFormat geoparquet_format();
/// `date`: what stands in the header of the DBF file as its last change.
VectorFormat shapefile_format(const std::string& date);

/// Errors: usage, where GDAL has no driver that writes the format.
Result<void> check_driver(const VectorFormat& format, std::string_view what, std::string_view where);

struct NamedBytes {
  std::string name, bytes;
};

/// The files of a table, made in memory: not all of GDAL's drivers notice a full disk. Most formats have one file,
/// named `stem` + extension; a shapefile has five. Reads them back and counts features. Equal tables give equal bytes.
/// Errors: usage (no driver), internal.
Result<std::vector<NamedBytes>> vector_files(const VectorTable& table, const VectorFormat& format,
                                             const std::string& stem, std::string_view what, std::string_view where);

}  // namespace rayfield::formats
