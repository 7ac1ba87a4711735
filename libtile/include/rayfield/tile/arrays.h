#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "rayfield/core/result.h"

namespace rayfield::tile {

using Array =
    std::variant<std::vector<std::uint8_t>, std::vector<std::uint16_t>, std::vector<std::int32_t>,
                 std::vector<std::uint32_t>, std::vector<std::int64_t>, std::vector<float>, std::vector<double>>;

/// A named set of columns with a JSON text: the form in which the store keeps derived data (ground, voxels, rows).
/// Equal content gives equal bytes.
struct ArraySet {
  std::string kind;        ///< "ground", "voxels" …
  int version = 1;         ///< of the layout of this kind
  std::string attributes;  ///< one JSON object: parameters, geometry, units of the columns
  std::map<std::string, Array> columns;

  /// The column of that name and type, or an error (damaged) that names what is missing.
  template <class T>
  Result<std::span<const T>> column(const std::string& name) const {
    const auto it = columns.find(name);
    if (it == columns.end() || !std::holds_alternative<std::vector<T>>(it->second))
      return fail(ErrorCode::damaged, "cannot read derived data", kind,
                  "column '" + name + "' is missing or of another type", "run `rayfield verify`");
    return std::span<const T>(std::get<std::vector<T>>(it->second));
  }
};

/// A column of floats that is too large to be in memory as a whole.
struct ColumnSource {
  std::uint64_t count = 0;
  /// Fills `values` with the elements from `first` on. Called part by part in ascending order, each element once.
  std::function<Result<void>(std::uint64_t first, std::span<float> values)> read;
};

/// Columns of which some come part by part; names do not repeat. Stored just as if all were in `arrays`.
struct StreamedArrays {
  ArraySet arrays;
  std::map<std::string, ColumnSource> streamed;
};

}  // namespace rayfield::tile
