#include <sys/stat.h>

#include <cerrno>

#include "libtile/files/file_io.h"
#include "libtile/store/store_impl.h"
#include "libtile/tile_file/tile_file.h"
#include "rayfield/core/sha256.h"
#include "rayfield/tile/store.h"

namespace rayfield::tile {
namespace {

tl::unexpected<Error> damaged(const std::filesystem::path& path, const std::string& why) {
  return fail(ErrorCode::damaged, "cannot read file of the store", path.string(), why, "run `rayfield verify`");
}

// A file that a snapshot names and that is not there is damage, not bad input; lack of permission stays what it is.
Error as_damage(Error error) {
  if (error.code == ErrorCode::bad_input) error.code = ErrorCode::damaged;
  return error;
}

}  // namespace

Result<void> Store::Impl::check_file(const FileEntry& file) const {
  const std::filesystem::path path = folder / file.path;
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno == ENOENT) return damaged(path, "the file is missing");
    return fail_errno(errno, "cannot read file of the store", path.string());
  }
  const Checked found{file.sha256, static_cast<std::uint64_t>(status.st_ino),
                      static_cast<std::uint64_t>(status.st_size), static_cast<std::int64_t>(status.st_mtim.tv_sec),
                      static_cast<std::int64_t>(status.st_mtim.tv_nsec)};
  if (found.size != file.size) return damaged(path, "the file is not as long as it was written");
  {
    const std::lock_guard lock(mutex_);
    const auto it = checked_.find(file.path);
    if (it != checked_.end() && it->second == found) return {};
  }
  const auto digest = digest_file(path, "cannot read file of the store");
  if (!digest) return tl::make_unexpected(as_damage(digest.error()));
  if (digest->sha256 != file.sha256) return damaged(path, "its SHA-256 is not that of the snapshot");
  const std::lock_guard lock(mutex_);
  checked_[file.path] = found;
  return {};
}

struct Store::TileReader::Impl {
  TileGrid grid;
  TileIndex index;
  std::vector<TilePart> parts;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> chunks;  // part, chunk within it
};

Result<Store::TileReader> Store::open_tile(const TileEntry& tile) const {
  const auto reader = std::make_shared<TileReader::Impl>(TileReader::Impl{TileGrid(impl_->config), tile.index, {}, {}});
  std::vector<FileEntry> files{tile.file};
  files.insert(files.end(), tile.more_files.begin(), tile.more_files.end());
  std::uint64_t segments = 0;
  for (std::uint32_t p = 0; p < files.size(); ++p) {
    RAYFIELD_CHECK(impl_->check_file(files[p]));
    const std::filesystem::path path = impl_->folder / files[p].path;
    RAYFIELD_ASSIGN(TilePart part, read_tile_part(path));
    if (part.header.index != tile.index || part.header.part != p || part.header.size != reader->grid.size ||
        part.header.margin != reader->grid.margin)
      return damaged(path, "it holds another tile than the snapshot says");
    segments += part.header.segments;
    for (std::uint32_t c = 0; c < part.chunks.size(); ++c) reader->chunks.emplace_back(p, c);
    reader->parts.push_back(std::move(part));
  }
  if (segments != tile.segment_count)
    return damaged(impl_->folder / tile.file.path, "it holds another number of segments than the snapshot says");
  TileReader result;
  result.impl_ = reader;
  return result;
}

std::size_t Store::TileReader::chunk_count() const { return impl_->chunks.size(); }

std::size_t Store::TileReader::chunk_size(std::size_t chunk) const {
  const auto [part, within] = impl_->chunks[chunk];
  return impl_->parts[part].chunks[within].count;
}

Result<void> Store::TileReader::read_chunk(std::size_t chunk, SegmentBatch& segments) const {
  const auto [part_number, within] = impl_->chunks[chunk];
  const TilePart& part = impl_->parts[part_number];
  const ChunkLayout& layout = part.chunks[within];
  static thread_local std::vector<std::byte> bytes;
  std::size_t total = 0;
  for (const ChunkPlace& place : layout.columns) total += place.size;
  bytes.resize(total);
  const auto file = open_for_reading(part.path, "cannot read file of the store");
  if (!file) return tl::make_unexpected(as_damage(file.error()));
  std::array<std::span<const std::byte>, kColumnCount> columns;
  std::size_t offset = 0;
  for (std::size_t k = 0; k < kColumnCount; ++k) {
    const auto target = std::span(bytes).subspan(offset, layout.columns[k].size);
    RAYFIELD_CHECK(read_at(*file, layout.columns[k].offset, target, part.path));
    columns[k] = target;
    offset += target.size();
  }
  return decode_chunk(columns, layout.count, layout.chunk_elements, impl_->index, impl_->grid, segments,
                      part.path.string());
}

Result<ArraySet> Store::read_derived(const DerivedEntry& entry) const {
  const std::filesystem::path path = impl_->folder / entry.file.path;
  const auto bytes = read_file(path, "cannot read file of the store");
  if (!bytes) return tl::make_unexpected(as_damage(bytes.error()));
  if (bytes->size() != entry.file.size || sha256_hex(*bytes) != entry.file.sha256)
    return damaged(path, "its SHA-256 is not that of the snapshot");
  RAYFIELD_ASSIGN(ArraySet arrays, decode_arrays(*bytes, path.string()));
  if (arrays.kind != entry.kind) return damaged(path, "it holds '" + arrays.kind + "', not '" + entry.kind + "'");
  return arrays;
}

}  // namespace rayfield::tile
