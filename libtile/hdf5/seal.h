#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace rayfield::tile {

/// "RAYFIELD-SHA256 " and 64 hexadecimal digits: the digest of everything before it. HDF5 does not look at bytes behind
/// its own end, so the file stays an ordinary HDF5 file.
inline constexpr std::string_view kSealMark = "RAYFIELD-SHA256 ";
inline constexpr std::size_t kSealSize = 80;

void append_seal(std::vector<std::byte>& content);
/// True where the last bytes are a seal that fits the bytes before it.
bool is_sealed(std::span<const std::byte> image);

}  // namespace rayfield::tile
