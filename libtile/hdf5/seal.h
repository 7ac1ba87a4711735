#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rayfield/core/sha256.h"

namespace rayfield::tile {

/// "RAYFIELD-SHA256 " and 64 hexadecimal digits: the digest of everything before it. HDF5 does not look at bytes behind
/// its own end, so the file stays an ordinary HDF5 file.
inline constexpr std::string_view kSealMark = "RAYFIELD-SHA256 ";
inline constexpr std::size_t kSealSize = 80;

inline std::string seal_of(std::span<const std::byte> content) { return std::string(kSealMark) + sha256_hex(content); }

inline void append_seal(std::vector<std::byte>& content) {
  const std::string seal = seal_of(content);
  const auto bytes = std::as_bytes(std::span(seal));
  content.insert(content.end(), bytes.begin(), bytes.end());
}

}  // namespace rayfield::tile
