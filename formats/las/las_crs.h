#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "formats/io/file_io.h"
#include "formats/las/las_header.h"

namespace rayfield::formats {

/// The CRS that a LAS file names.
struct LasCrs {
  std::optional<std::string>
      text;          ///< "EPSG:7854", or WKT where PROJ knows no code for it; nothing where none is named
  std::string name;  ///< for people: the code, or the name in the WKT
  std::string note;  ///< what to say where keys name a CRS that has no code
};

/// Walks the records of variable length, and the extended ones if they are there, and takes the CRS from WKT
/// (LASF_Projection, 2112) or GeoTIFF keys (34735), whichever the global encoding says, or the one that there is.
/// Errors: bad_input with path and offset (a record that reaches into the points or out of the file), resources.
Result<LasCrs> read_las_crs(FileWindow& window, const LasHeader& header);

/// "EPSG:7854" of a GeoKeyDirectoryTag (OGC GeoTIFF 1.1): ProjectedCSTypeGeoKey (3072), or where the model is
/// geographic GeographicTypeGeoKey (2048); nothing where the CRS is another or the keys are malformed.
std::optional<std::string> crs_of_geokeys(std::span<const std::byte> keys);

}  // namespace rayfield::formats
