#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "libtile/hdf5/seal.h"

namespace rayfield::tile::testing {

/// A file of a store made of an HDF5 image that was tampered with: its length put where the superblock states it, and a
/// seal that fits. This is what somebody can do who means harm.
inline std::vector<std::byte> resealed(std::span<const std::byte> image) {
  constexpr std::size_t kStatedLength = 44;
  std::vector<std::byte> file(image.begin(), image.end());
  const std::uint64_t size = file.size();
  if (size >= kStatedLength + sizeof(size)) std::memcpy(file.data() + kStatedLength, &size, sizeof(size));
  append_seal(file);
  return file;
}

}  // namespace rayfield::tile::testing
