#pragma once

/// ray_cloud: rays in PLY files, in the layout of raycloudtools.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/number_type.h"
#include "rayfield/core/result.h"

namespace rayfield::formats {

struct PlyProperty {
  std::string name;
  NumberType type = NumberType::f32;
  std::size_t offset = 0;  ///< in the row of a vertex
};

/// The header of a binary little-endian PLY file with vertices of fixed size.
struct PlyHeader {
  std::uint64_t vertex_count = 0;
  std::vector<PlyProperty> properties;
  std::size_t row_bytes = 0;
  std::size_t header_bytes = 0;  ///< the vertices begin here
  bool more_elements = false;    ///< non-empty elements follow the vertices
  std::vector<std::string> comments;

  const PlyProperty* find(std::string_view name) const;
};

/// Longest header that is looked at.
inline constexpr std::size_t kMaxPlyHeader = std::size_t{64} << 10;

/// Parses the header at the beginning of `bytes` (the first kMaxPlyHeader bytes of the file or all of it).
/// Errors: bad_input with the header's line in `where`.
Result<PlyHeader> parse_ply_header(std::string_view bytes);

/// Where the columns of a ray cloud lie in a row.
struct RayColumns {
  std::size_t position = 0, start = 0, time = 0;  ///< offsets; the three coordinates follow one another
  bool position_double = true, start_double = false, time_double = true;
  std::optional<std::size_t> alpha;  ///< nothing: every ray is a hit
};

/// Finds the columns of a ray cloud. Errors: bad_input where something is missing or of a type that makes no sense.
Result<RayColumns> find_ray_columns(const PlyHeader& header);

}  // namespace rayfield::formats
