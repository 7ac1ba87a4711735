#pragma once

/// point_cloud: hits coloured by the density of their voxels, as PLY and LAS.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "rayfield/core/density_points.h"
#include "rayfield/core/result.h"
#include "rayfield/formats/point_cloud.h"

namespace rayfield::formats {

inline constexpr const char* kPointCloudWhat = "cannot write point cloud";

/// ASPRS classes: of canopy "high vegetation", of posts and trunks the first that users may define.
inline constexpr std::uint8_t kCanopyClass = 5, kWoodClass = 64;
inline std::uint8_t class_of(PointKind kind) { return kind == PointKind::wood ? kWoodClass : kCanopyClass; }

/// One form of a point cloud: a header as long for any number of points, and records of one length.
class PointFormat {
 public:
  virtual ~PointFormat() = default;
  /// The header for the points given to add() so far.
  virtual std::string header() const = 0;
  virtual std::size_t record_bytes() const = 0;
  /// Appends the record of one point. Errors: bad_input, without the place.
  virtual Result<void> add(const DensityPoints& points, std::size_t i, const Rgba& color,
                           std::vector<std::byte>& to) = 0;
  std::uint64_t count = 0;  ///< of points so far
};

/// Appends a little-endian number (the machine's own order, see byte_cursor.h).
template <class T>
void append_number(std::vector<std::byte>& to, T value) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
  to.insert(to.end(), bytes, bytes + sizeof(T));
}

}  // namespace rayfield::formats
