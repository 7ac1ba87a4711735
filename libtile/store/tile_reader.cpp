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

  const TilePart& part_of(std::size_t chunk) const { return parts[chunks[chunk].first]; }
  const ChunkLayout& layout_of(std::size_t chunk) const { return part_of(chunk).chunks[chunks[chunk].second]; }
  Result<EncodedColumns> read(std::size_t chunk, const std::array<bool, kColumnCount>& wanted) const;
};

// The bytes of a chunk's columns, those that are not wanted empty; valid until the thread reads the next.
Result<EncodedColumns> TileReader::Impl::read(std::size_t chunk, const std::array<bool, kColumnCount>& wanted) const {
  const std::filesystem::path& path = part_of(chunk).path;
  const ChunkLayout& layout = layout_of(chunk);
  static thread_local std::vector<std::byte> bytes;
  std::size_t total = 0;
  for (const ChunkPlace& place : layout.columns) total += place.size;
  bytes.resize(total);
  const auto file = open_regular_file(path.string(), "cannot read file of the store");
  if (!file) return tl::make_unexpected(as_damage(file.error()));
  EncodedColumns columns;
  std::size_t offset = 0;
  for (std::size_t k = 0; k < kColumnCount; ++k) {
    if (!wanted[k]) continue;
    const auto target = std::span(bytes).subspan(offset, layout.columns[k].size);
    RAYFIELD_CHECK(read_exactly(file->descriptor, layout.columns[k].offset, target, path));
    columns[k] = target;
    offset += target.size();
  }
  return columns;
}

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

std::size_t TileReader::chunk_size(std::size_t chunk) const { return impl_->layout_of(chunk).count; }

Result<void> TileReader::read_chunk(std::size_t chunk, SegmentBatch& segments) const {
  RAYFIELD_ASSIGN(const EncodedColumns columns, impl_->read(chunk, kAllColumns));
  const ChunkLayout& layout = impl_->layout_of(chunk);
  return decode_chunk(columns, layout.count, layout.chunk_elements, impl_->index, impl_->grid, segments,
                      impl_->part_of(chunk).path.string());
}

Result<void> TileReader::read_hits(std::size_t chunk, HitBatch& hits) const {
  RAYFIELD_ASSIGN(const EncodedColumns columns, impl_->read(chunk, kColumnsOfHits));
  const ChunkLayout& layout = impl_->layout_of(chunk);
  return decode_hits(columns, layout.count, layout.chunk_elements, impl_->index, impl_->grid, hits,
                     impl_->part_of(chunk).path.string());
}

}  // namespace rayfield::tile
