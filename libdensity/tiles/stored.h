#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "rayfield/tile/arrays.h"

namespace rayfield::density {

/// Readers of stored derived data: every count and number is checked before it is used.
inline tl::unexpected<Error> damaged(const tile::ArraySet& arrays, const std::string& why) {
  return fail(ErrorCode::damaged, "cannot read derived data", arrays.kind, why, "run `rayfield verify`");
}

/// The attributes, after kind and version were checked.
inline Result<nlohmann::json> stored_attributes(const tile::ArraySet& arrays, const std::string& kind, int version) {
  if (arrays.kind != kind || arrays.version != version)
    return damaged(arrays, "expected " + kind + " version " + std::to_string(version));
  nlohmann::json json = nlohmann::json::parse(arrays.attributes, nullptr, false);
  if (!json.is_object()) return damaged(arrays, "the attributes are no JSON object");
  return json;
}

/// A finite number among the attributes.
inline Result<double> stored_number(const tile::ArraySet& arrays, const nlohmann::json& json, const std::string& name) {
  const auto it = json.find(name);
  if (it == json.end() || !it->is_number()) return damaged(arrays, "attribute '" + name + "' is missing");
  return it->get<double>();
}

/// A whole number between two bounds.
inline Result<int> stored_count(const tile::ArraySet& arrays, const nlohmann::json& json, const std::string& name,
                                int low, int high) {
  const auto it = json.find(name);
  if (it == json.end() || !it->is_number_integer() || it->get<std::int64_t>() < low || it->get<std::int64_t>() > high)
    return damaged(arrays, "attribute '" + name + "' is missing or out of range");
  return it->get<int>();
}

/// How many there are of something; 0 where versions before did not say.
inline Result<std::int64_t> stored_total(const tile::ArraySet& arrays, const nlohmann::json& json,
                                         const std::string& name) {
  const auto it = json.find(name);
  if (it == json.end()) return 0;
  if (!it->is_number_integer() || it->get<std::int64_t>() < 0)
    return damaged(arrays, "attribute '" + name + "' is no count");
  return it->get<std::int64_t>();
}

/// A column of an expected length.
template <class T>
Result<std::span<const T>> stored_column(const tile::ArraySet& arrays, const std::string& name, std::size_t length) {
  Result<std::span<const T>> column = arrays.column<T>(name);
  if (column && column->size() != length)
    return damaged(arrays, "column '" + name + "' has " + std::to_string(column->size()) + " entries, expected " +
                               std::to_string(length));
  return column;
}

}  // namespace rayfield::density
