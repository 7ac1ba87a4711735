#include "rayfield/tile/array_reader.h"

#include <algorithm>
#include <limits>

#include "libtile/files/file_io.h"
#include "libtile/hdf5/array_image.h"
#include "libtile/hdf5/h5_read.h"
#include "libtile/store/open_store.h"
#include "rayfield/core/file.h"

namespace rayfield::tile {

struct ArrayReader::Impl {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  std::filesystem::path path;
  FileDescriptor file;
  ImageLayout layout;
  ArraySet header;
  std::vector<std::byte> compressed;
  // The chunk decoded last.
  const ColumnLayout* column = nullptr;
  std::size_t chunk = kNone;
  std::vector<float> values;

  Result<std::span<const std::byte>> fetch(const ChunkPlace& place) {
    compressed.resize(place.size);
    RAYFIELD_CHECK(read_exactly(file, place.offset, compressed, path));
    return std::span<const std::byte>(compressed);
  }

  Result<const ColumnLayout*> floats(const std::string& name) const {
    const ColumnLayout* found = layout.find(name);
    if (found == nullptr || found->type != ElementType::f32)
      return file_damaged(path, "column '" + name + "' is missing or of another type");
    return found;
  }

  Result<void> decode(const ColumnLayout& wanted, std::size_t number) {
    if (column == &wanted && chunk == number) return {};
    column = nullptr;
    values.resize(wanted.chunk_elements);
    RAYFIELD_CHECK(decode_column_chunk(
        wanted, number, [this](const ChunkPlace& place) { return fetch(place); },
        std::as_writable_bytes(std::span(values)), path.string()));
    column = &wanted, chunk = number;
    return {};
  }
};

Result<ArrayReader> ArrayReader::open(const OpenStore& store, const DerivedEntry& entry) {
  RAYFIELD_CHECK(store.files.check(entry.file));
  const auto impl = std::make_shared<Impl>();
  impl->path = store.folder / entry.file.path;
  auto input = open_regular_file(impl->path.string(), "cannot read file of the store");
  if (!input) return tl::make_unexpected(as_damage(std::move(input).error()));
  impl->file = std::move(input->descriptor);
  RAYFIELD_ASSIGN(impl->layout, read_layout(impl->path));
  RAYFIELD_ASSIGN(impl->header, decode_header(impl->layout, impl->path.string()));
  if (impl->header.kind != entry.kind)
    return file_damaged(impl->path, "it holds '" + impl->header.kind + "', not '" + entry.kind + "'");
  ArrayReader reader;
  reader.impl_ = impl;
  return reader;
}

const ArraySet& ArrayReader::header() const { return impl_->header; }

Result<std::uint64_t> ArrayReader::count(const std::string& column) const {
  RAYFIELD_ASSIGN(const ColumnLayout* const found, impl_->floats(column));
  return found->count;
}

Result<void> ArrayReader::read(const std::string& column, std::uint64_t first, std::span<float> values) const {
  RAYFIELD_ASSIGN(const ColumnLayout* const found, impl_->floats(column));
  if (first > found->count || values.size() > found->count - first)
    return file_damaged(impl_->path, "column '" + column + "' is cut short");
  std::size_t done = 0;
  while (done < values.size()) {
    const std::uint64_t at = first + done;
    RAYFIELD_CHECK(impl_->decode(*found, at / found->chunk_elements));
    const std::size_t within = at % found->chunk_elements;
    const std::size_t part = std::min<std::size_t>(found->chunk_elements - within, values.size() - done);
    std::copy_n(impl_->values.begin() + static_cast<std::ptrdiff_t>(within), part,
                values.begin() + static_cast<std::ptrdiff_t>(done));
    done += part;
  }
  return {};
}

Result<ArraySet> ArrayReader::read_without(const std::vector<std::string>& columns) const {
  ArraySet arrays = impl_->header;
  for (const ColumnLayout& column : impl_->layout.columns) {
    if (std::find(columns.begin(), columns.end(), column.name) != columns.end()) continue;
    RAYFIELD_ASSIGN(Array array,
                    decode_column(
                        column, [this](const ChunkPlace& place) { return impl_->fetch(place); }, impl_->path.string()));
    arrays.columns.emplace(column.name, std::move(array));
  }
  return arrays;
}

}  // namespace rayfield::tile
