#pragma once

/// tile_file: the content of a tile file: rays clipped to a tile, in integers, as compressed columns.

#include <filesystem>
#include <vector>

#include "libtile/hdf5/h5_read.h"
#include "libtile/tile_file/chunk_codec.h"

namespace rayfield::tile {

/// What a tile file says of itself. A tile with more than kChunksPerPart chunks is spread over several files, so that
/// building one takes bounded memory however dense the tile is.
struct TilePartHeader {
  TileIndex index;
  std::uint32_t part = 0;  ///< from 0, in the order of the scan
  std::uint64_t segments = 0;
  std::int64_t size = 0, margin = 0;  ///< of the grid, in units
};

/// The bytes of a tile file: chunks in the order of the scan, all of equal chunk_elements.
Result<std::vector<std::byte>> build_tile_part(const TilePartHeader& header, const std::vector<EncodedChunk>& chunks);

struct ChunkLayout {
  std::uint32_t count = 0, chunk_elements = 0;
  std::array<ChunkPlace, kColumnCount> columns;
};

struct TilePart {
  std::filesystem::path path;
  TilePartHeader header;
  std::vector<ChunkLayout> chunks;
};

/// Structure of a tile file whose SHA-256 has been checked. Errors: damaged.
Result<TilePart> read_tile_part(const std::filesystem::path& path);

}  // namespace rayfield::tile
