#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rayfield/core/result.h"

/// Compression of one column of one chunk: a Blosc 1 buffer (byte shuffle, then Zstandard at level 1, one Blosc block).
/// One block per buffer puts each byte plane of a full chunk into Zstandard blocks of its own, with their own
/// Huffman tables: the upper planes of small numbers then cost almost nothing.
namespace rayfield::tile {

/// Identifier of the Blosc filter in the HDF Group's registry, and its parameters as HDF5 stores them.
inline constexpr int kBloscFilter = 32001;
std::vector<unsigned> blosc_filter_values(std::size_t element_size, std::size_t chunk_bytes);

/// The header of a Blosc buffer, without which there is none.
inline constexpr std::size_t kLeastBufferBytes = 16;

/// Appends the compressed form of `raw` to `out` and returns its size.
std::size_t compress(std::span<const std::byte> raw, std::size_t element_size, std::vector<std::byte>& out);

/// The inverse. `blob` may hold anything: what is not a buffer of exactly raw.size() bytes is refused (false).
bool decompress(std::span<const std::byte> blob, std::span<std::byte> raw);

/// Small signed numbers become small unsigned ones: 0, -1, 1, -2 … → 0, 1, 2, 3 … (arithmetic modulo 2^n, exact).
inline std::uint32_t zigzag(std::uint32_t v) { return (v << 1U) ^ (0U - (v >> 31U)); }
inline std::uint32_t unzigzag(std::uint32_t z) { return (z >> 1U) ^ (0U - (z & 1U)); }
inline std::uint64_t zigzag(std::uint64_t v) { return (v << 1U) ^ (std::uint64_t{0} - (v >> 63U)); }
inline std::uint64_t unzigzag(std::uint64_t z) { return (z >> 1U) ^ (std::uint64_t{0} - (z & 1U)); }

}  // namespace rayfield::tile
