#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <variant>

#include "rayfield/tile/arrays.h"

/// Arrays as plain bytes, without HDF5 and seal around them, so that what a fuzzer changes reaches the columns: kind,
/// version, attributes, then columns to the end (name, type, number of elements, elements). Lengths have two bytes.
namespace rayfield::fuzz {

inline void put(std::string& out, const void* data, std::size_t size) {
  out.append(static_cast<const char*>(data), size);
}

inline void put_length(std::string& out, std::size_t length) {
  const auto two_bytes = static_cast<std::uint16_t>(length);
  put(out, &two_bytes, sizeof two_bytes);
}

inline std::string pack(const tile::ArraySet& arrays) {
  std::string out;
  put_length(out, arrays.kind.size()), out += arrays.kind;
  put_length(out, static_cast<std::size_t>(arrays.version));
  put_length(out, arrays.attributes.size()), out += arrays.attributes;
  for (const auto& [name, column] : arrays.columns) {
    put_length(out, name.size()), out += name;
    put_length(out, column.index());
    const auto put_values = [&out](const auto& values) {
      put_length(out, values.size());
      if (!values.empty()) put(out, values.data(), values.size() * sizeof values[0]);
    };
    std::visit(put_values, column);
  }
  return out;
}

/// Reads what there is; what is missing at the end is empty.
class Unpacker {
 public:
  explicit Unpacker(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  tile::ArraySet read() {
    tile::ArraySet out;
    out.kind = text(), out.version = static_cast<int>(length()), out.attributes = text();
    while (!rest_.empty()) {
      const std::string name = text();
      out.columns[name] = column(length(), std::make_index_sequence<std::variant_size_v<tile::Array>>());
    }
    return out;
  }

 private:
  std::span<const std::uint8_t> take(std::size_t size) {
    const auto out = rest_.first(std::min(size, rest_.size()));
    rest_ = rest_.subspan(out.size());
    return out;
  }
  std::size_t length() {
    std::uint16_t out = 0;
    const auto bytes = take(sizeof out);
    if (!bytes.empty()) std::memcpy(&out, bytes.data(), bytes.size());
    return out;
  }
  std::string text() {
    const auto bytes = take(length());
    return {bytes.begin(), bytes.end()};
  }
  template <std::size_t... I>
  tile::Array column(std::size_t type, std::index_sequence<I...> /*types*/) {
    tile::Array out;
    ((type % sizeof...(I) == I ? void(out.emplace<I>()) : void()), ...);
    std::visit(
        [this](auto& values) {
          const auto bytes = take(length() * sizeof values[0]);
          values.resize(bytes.size() / sizeof values[0]);
          if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof values[0]);
        },
        out);
    return out;
  }
  std::span<const std::uint8_t> rest_;
};

}  // namespace rayfield::fuzz
