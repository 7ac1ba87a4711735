#include "libtile/hdf5/seal.h"

#include <cstring>
#include <string>

#include "rayfield/core/sha256.h"

namespace rayfield::tile {
namespace {

std::string seal_of(std::span<const std::byte> content) { return std::string(kSealMark) + sha256_hex(content); }

}  // namespace

void append_seal(std::vector<std::byte>& content) {
  const std::string seal = seal_of(content);
  const auto bytes = std::as_bytes(std::span(seal));
  content.insert(content.end(), bytes.begin(), bytes.end());
}

bool is_sealed(std::span<const std::byte> image) {
  if (image.size() < kSealSize) return false;
  const auto stated = image.last(kSealSize);
  if (std::memcmp(stated.data(), kSealMark.data(), kSealMark.size()) != 0) return false;
  const std::string seal = seal_of(image.first(image.size() - kSealSize));
  return std::memcmp(stated.data(), seal.data(), kSealSize) == 0;
}

}  // namespace rayfield::tile
