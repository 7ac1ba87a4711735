#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace rayfield::formats {

/// What a farm management system takes: a zipped polygon shapefile in longitude and latitude (EPSG:4326), with these
/// rules. docs/farm-systems.md has where each of them is stated, and what is not stated anywhere.
struct FarmProfile {
  std::string_view name;
  std::string_view folder;        ///< inside the archive, with a slash at its end
  bool projection_files = true;   ///< with .prj and .cpg beside .shp, .shx and .dbf
  bool field_dictionary = false;  ///< with a text file that says what the columns mean
  bool numbers_only = false;      ///< columns of text and dates are left out
  std::size_t most_columns = 0;   ///< the rest is left out; 0: no limit
  std::size_t most_features = 0;  ///< a block with more is refused; 0: no limit
};

/// All known profiles, the plain one first.
std::span<const FarmProfile> farm_profiles();
/// The profile of that name, or null.
const FarmProfile* find_farm_profile(std::string_view name);

}  // namespace rayfield::formats
