#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libtile/hdf5/element_type.h"
#include "libtile/tile_file/tile_grid.h"
#include "rayfield/core/result.h"
#include "rayfield/tile/segments.h"

namespace rayfield::tile {

/// Segments of a chunk, and chunks of a tile file. They are part of the format: the bytes of a tile depend on them.
inline constexpr std::size_t kChunkSegments = 131072;
inline constexpr std::size_t kChunksPerPart = 8;

/// One ray of one tile between partition and encoding: 36 bytes.
struct RayRecord {
  LocalRay geometry;
  std::uint32_t time_low;  ///< Unix time in µs, 64 bits in two halves so that records need no padding
  std::uint32_t time_high;
  std::uint16_t intensity;
  std::uint8_t flags;  ///< SegmentFlag
  std::uint8_t unused;
};
static_assert(sizeof(RayRecord) == 36);

struct ColumnSpec {
  const char* name;
  ElementType type;
};
inline constexpr std::size_t kColumnCount = 9;
/// Order of the columns of a tile; the first eight hold zigzag-coded differences (docs/store-format.md).
inline constexpr std::array<ColumnSpec, kColumnCount> kTileColumns{{{"origin_x", ElementType::u32},
                                                                    {"origin_y", ElementType::u32},
                                                                    {"origin_z", ElementType::u32},
                                                                    {"ray_x", ElementType::u32},
                                                                    {"ray_y", ElementType::u32},
                                                                    {"ray_z", ElementType::u32},
                                                                    {"time", ElementType::u64},
                                                                    {"intensity", ElementType::u16},
                                                                    {"flags", ElementType::u8}}};

/// Of a chunk, in the order of kTileColumns.
using EncodedColumns = std::array<std::span<const std::byte>, kColumnCount>;
/// Which of them a reader wants.
inline constexpr std::array<bool, kColumnCount> kAllColumns{true, true, true, true, true, true, true, true, true};
inline constexpr std::array<bool, kColumnCount> kColumnsOfHits{true, true, true, true, true, true, false, false, true};

/// A compressed chunk: its columns' buffers one after the other.
struct EncodedChunk {
  std::uint32_t count = 0;           ///< segments
  std::uint32_t chunk_elements = 0;  ///< count, or more where the last chunk of a file is padded
  std::array<std::uint32_t, kColumnCount> sizes{};
  std::vector<std::byte> bytes;

  EncodedColumns columns() const;
};

/// What a chunk adds to its tile's entry.
struct ChunkSummary {
  std::uint64_t segments = 0, starts = 0, hits = 0;  ///< hits in the tile proper
  Eigen::AlignedBox3d bounds;                        ///< of the clipped segments, map m
  void add(const ChunkSummary& other);
};

/// Compresses 1 … kChunkSegments records; `chunk_elements` ≥ their number pads.
EncodedChunk encode_chunk(std::span<const RayRecord> records, std::size_t chunk_elements);

ChunkSummary summarize(std::span<const RayRecord> records, TileIndex tile, const TileGrid& grid);

/// Decompresses a chunk and clips its rays to the widened tile. Errors: damaged.
Result<void> decode_chunk(const EncodedColumns& columns, std::size_t count, std::size_t chunk_elements, TileIndex tile,
                          const TileGrid& grid, SegmentBatch& segments, const std::string& where);
/// The same of its hits alone, of kColumnsOfHits.
Result<void> decode_hits(const EncodedColumns& columns, std::size_t count, std::size_t chunk_elements, TileIndex tile,
                         const TileGrid& grid, HitBatch& hits, const std::string& where);

}  // namespace rayfield::tile
