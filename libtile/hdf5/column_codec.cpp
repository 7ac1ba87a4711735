#include "libtile/hdf5/column_codec.h"

#include <blosc.h>

#include <stdexcept>

namespace rayfield::tile {
namespace {
constexpr int kLevel = 1;
static_assert(kLeastBufferBytes == BLOSC_MIN_HEADER_LENGTH);
}  // namespace

std::vector<unsigned> blosc_filter_values(std::size_t element_size, std::size_t chunk_bytes) {
  // Filter revision, buffer format, element size, chunk size, level, shuffle, compressor: as the registered filter
  // writes them.
  return {2U,
          BLOSC_VERSION_FORMAT,
          static_cast<unsigned>(element_size),
          static_cast<unsigned>(chunk_bytes),
          static_cast<unsigned>(kLevel),
          BLOSC_SHUFFLE,
          BLOSC_ZSTD};
}

std::size_t compress(std::span<const std::byte> raw, std::size_t element_size, std::vector<std::byte>& out) {
  const std::size_t before = out.size();
  const std::size_t limit = raw.size() + BLOSC_MAX_OVERHEAD;
  out.resize(before + limit);
  const int size = blosc_compress_ctx(kLevel, BLOSC_SHUFFLE, element_size, raw.size(), raw.data(), out.data() + before,
                                      limit, BLOSC_ZSTD_COMPNAME, raw.size(), 1);
  // The buffer has room for incompressible data: only a library without Zstandard comes here.
  if (size <= 0) throw std::runtime_error("Blosc cannot compress with Zstandard");
  out.resize(before + static_cast<std::size_t>(size));
  return static_cast<std::size_t>(size);
}

bool decompress(std::span<const std::byte> blob, std::span<std::byte> raw) {
  if (blob.size() < kLeastBufferBytes) return false;
  std::size_t declared = 0;
  if (blosc_cbuffer_validate(blob.data(), blob.size(), &declared) != 0 || declared != raw.size()) return false;
  if (raw.empty()) return true;
  return blosc_decompress_ctx(blob.data(), raw.data(), raw.size(), 1) == static_cast<int>(raw.size());
}

}  // namespace rayfield::tile
