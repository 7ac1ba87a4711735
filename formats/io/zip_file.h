#pragma once

#include <span>
#include <string>
#include <string_view>

#include "rayfield/core/result.h"

namespace rayfield::formats {

struct ZipMember {
  std::string name;  ///< with its folder, if any: "Rx/zones.shp"; ASCII, which every program reads the same
  std::string_view bytes;
};

/// Writes a ZIP archive that appears whole or not at all. Members bear the date (YYYY-MM-DD, 00:00; 1980 to 2107, what
/// lies outside takes the nearest), not the time of writing: equal members give equal bytes. minizip writes it: GDAL's
/// own ZIP writer, which packs projects in memory (qgis/qgz.h), cannot date members before GDAL 3.7.
/// Errors: resources, bad_input (no such folder), usage (the target is a folder).
Result<void> write_zip(std::span<const ZipMember> members, const std::string& date, const std::string& path,
                       std::string_view what);

}  // namespace rayfield::formats
