#include "rayfield/tile/tile_reader.h"

#include "libtile/files/file_io.h"
#include "libtile/store/open_store.h"
#include "libtile/tile_file/tile_file.h"
#include "rayfield/core/file.h"

namespace rayfield::tile {

struct TileReader::Impl {
  TileGrid grid;
  TileIndex index;
  std::vector<TilePart> parts;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> chunks;  // part, chunk within it
};

Result<TileReader> TileReader::open(const OpenStore& store, const TileEntry& tile) {
  const auto reader = std::make_shared<Impl>(Impl{TileGrid(store.config), tile.index, {}, {}});
  std::vector<FileEntry> files{tile.file};
  files.insert(files.end(), tile.more_files.begin(), tile.more_files.end());
  std::uint64_t segments = 0;
  for (std::uint32_t p = 0; p < files.size(); ++p) {
    RAYFIELD_CHECK(store.files.check(files[p]));
    const std::filesystem::path path = store.folder / files[p].path;
    RAYFIELD_ASSIGN(TilePart part, read_tile_part(path));
    if (part.header.index != tile.index || part.header.part != p || part.header.size != reader->grid.size ||
        part.header.margin != reader->grid.margin)
      return file_damaged(path, "it holds another tile than the snapshot says");
    segments += part.header.segments;
    for (std::uint32_t c = 0; c < part.chunks.size(); ++c) reader->chunks.emplace_back(p, c);
    reader->parts.push_back(std::move(part));
  }
  if (segments != tile.segment_count)
    return file_damaged(store.folder / tile.file.path, "it holds another number of segments than the snapshot says");
  TileReader result;
  result.impl_ = reader;
  return result;
}

std::size_t TileReader::chunk_count() const { return impl_->chunks.size(); }

std::size_t TileReader::chunk_size(std::size_t chunk) const {
  const auto [part, within] = impl_->chunks[chunk];
  return impl_->parts[part].chunks[within].count;
}

Result<void> TileReader::read_chunk(std::size_t chunk, SegmentBatch& segments) const {
  const auto [part_number, within] = impl_->chunks[chunk];
  const TilePart& part = impl_->parts[part_number];
  const ChunkLayout& layout = part.chunks[within];
  static thread_local std::vector<std::byte> bytes;
  std::size_t total = 0;
  for (const ChunkPlace& place : layout.columns) total += place.size;
  bytes.resize(total);
  const auto file = open_regular_file(part.path.string(), "cannot read file of the store");
  if (!file) return tl::make_unexpected(as_damage(file.error()));
  std::array<std::span<const std::byte>, kColumnCount> columns;
  std::size_t offset = 0;
  for (std::size_t k = 0; k < kColumnCount; ++k) {
    const auto target = std::span(bytes).subspan(offset, layout.columns[k].size);
    RAYFIELD_CHECK(read_exactly(file->descriptor, layout.columns[k].offset, target, part.path));
    columns[k] = target;
    offset += target.size();
  }
  return decode_chunk(columns, layout.count, layout.chunk_elements, impl_->index, impl_->grid, segments,
                      part.path.string());
}

}  // namespace rayfield::tile
