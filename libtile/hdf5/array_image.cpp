#include "libtile/hdf5/array_image.h"

#include <algorithm>
#include <exception>
#include <nlohmann/json.hpp>

#include "libtile/hdf5/column_codec.h"
#include "libtile/hdf5/h5_layout.h"
#include "libtile/hdf5/h5_write.h"
#include "rayfield/tile/whole_number.h"

namespace rayfield::tile {
namespace {

constexpr std::size_t kUsualCompression = 1024;
constexpr const char* kFormat = "rayfield-arrays";
constexpr int kVersion = 1;

tl::unexpected<Error> damaged(const std::string& where, const std::string& why) {
  return fail(ErrorCode::damaged, "cannot read derived data", where, why, "run `rayfield verify`");
}

// One column, its chunks compressed.
struct CompressedColumn {
  ImageColumn column;
  std::vector<std::vector<std::byte>> chunks;
};

// `part(first, count, scratch)` → Result<std::span<const T>>, the elements themselves or what it put into `scratch`.
template <class T, class Part>
Result<CompressedColumn> compress_column(const std::string& name, std::uint64_t size, const Part& part) {
  CompressedColumn result;
  result.column.name = name;
  result.column.type = type_of<T>();
  result.column.count = size;
  const std::size_t chunk = std::clamp<std::size_t>(size, 1, kMostChunkElements);
  result.column.chunk_elements = chunk;
  std::vector<T> scratch;
  std::vector<std::byte> bytes;
  for (std::uint64_t first = 0; first < size; first += chunk) {
    const std::size_t count = std::min<std::uint64_t>(chunk, size - first);
    RAYFIELD_ASSIGN(std::span<const T> values, part(first, count, scratch));
    if (count < chunk) {
      std::vector<T> padded(values.begin(), values.end());
      padded.resize(chunk);
      scratch.swap(padded);
      values = scratch;
    }
    bytes.clear();
    compress(std::as_bytes(values), sizeof(T), bytes);
    result.chunks.emplace_back(bytes.begin(), bytes.end());
  }
  for (const std::vector<std::byte>& compressed : result.chunks) result.column.chunks.emplace_back(compressed);
  return result;
}

template <class T>
Result<CompressedColumn> compress_values(const std::string& name, const std::vector<T>& values) {
  return compress_column<T>(name, values.size(),
                            [&](std::uint64_t first, std::size_t count, auto&) -> Result<std::span<const T>> {
                              return std::span<const T>(values).subspan(first, count);
                            });
}

Result<CompressedColumn> compress_source(const std::string& name, const ColumnSource& source) {
  return compress_column<float>(
      name, source.count,
      [&](std::uint64_t first, std::size_t count, std::vector<float>& scratch) -> Result<std::span<const float>> {
        scratch.resize(count);
        RAYFIELD_CHECK(source.read(first, scratch));
        return std::span<const float>(scratch);
      });
}

// Room for the claimed length is reserved where chunks of that size can hold it; beyond that, memory grows with what is
// really decompressed.
template <class T>
Result<Array> read_column(const ColumnLayout& column, const FetchChunk& fetch, const std::string& where) {
  std::uint64_t compressed_bytes = 0;
  for (const ChunkPlace& chunk : column.chunks) compressed_bytes += chunk.size;
  std::vector<T> values;
  values.reserve(std::min<std::uint64_t>(column.count, compressed_bytes * kUsualCompression / sizeof(T)));
  std::vector<T> padded;
  for (std::size_t c = 0; c < column.chunks.size(); ++c) {
    const std::size_t first = values.size();
    const std::size_t count = std::min<std::uint64_t>(column.chunk_elements, column.count - first);
    values.resize(first + count);
    std::span<T> target(values.data() + first, count);
    if (count < column.chunk_elements) {
      padded.resize(column.chunk_elements);
      target = padded;
    }
    RAYFIELD_CHECK(decode_column_chunk(column, c, fetch, std::as_writable_bytes(target), where));
    if (count < column.chunk_elements)
      std::copy_n(padded.begin(), count, values.begin() + static_cast<std::ptrdiff_t>(first));
  }
  return Array(std::move(values));
}

Result<void> read_attributes(const std::string& text, ArraySet& arrays, const std::string& where) {
  try {
    const nlohmann::json json = nlohmann::json::parse(text);
    if (json.at("format") != kFormat) return damaged(where, "it holds no derived data");
    if (json.at("version") != kVersion) return damaged(where, "it was written by a newer version of rayfield");
    arrays.kind = json.at("kind").get<std::string>();
    arrays.version = whole_number<int>(json.at("kind_version"));
    arrays.attributes = json.at("attributes").get<std::string>();
  } catch (const std::exception& e) {
    return damaged(where, std::string("its attributes are not what they should be: ") + e.what());
  }
  return {};
}

}  // namespace

Result<void> decode_column_chunk(const ColumnLayout& column, std::size_t chunk, const FetchChunk& fetch,
                                 std::span<std::byte> bytes, const std::string& where) {
  RAYFIELD_ASSIGN(const std::span<const std::byte> compressed, fetch(column.chunks[chunk]));
  if (!decompress(compressed, bytes)) return damaged(where, "column '" + column.name + "' cannot be decompressed");
  return {};
}

Result<Array> decode_column(const ColumnLayout& column, const FetchChunk& fetch, const std::string& where) {
  switch (column.type) {
    case ElementType::u8:
      return read_column<std::uint8_t>(column, fetch, where);
    case ElementType::u16:
      return read_column<std::uint16_t>(column, fetch, where);
    case ElementType::i32:
      return read_column<std::int32_t>(column, fetch, where);
    case ElementType::u32:
      return read_column<std::uint32_t>(column, fetch, where);
    case ElementType::i64:
      return read_column<std::int64_t>(column, fetch, where);
    case ElementType::f32:
      return read_column<float>(column, fetch, where);
    case ElementType::f64:
      return read_column<double>(column, fetch, where);
    case ElementType::u64:
      break;
  }
  return damaged(where, "column '" + column.name + "' has a type that derived data does not use");
}

Result<ArraySet> decode_header(const ImageLayout& layout, const std::string& where) {
  ArraySet arrays;
  RAYFIELD_CHECK(read_attributes(layout.attributes, arrays, where));
  return arrays;
}

Result<std::vector<std::byte>> encode_arrays(const ArraySet& arrays,
                                             const std::map<std::string, ColumnSource>& streamed) {
  std::string header;
  try {
    // The caller's JSON stays a text inside ours: it comes back byte for byte.
    header = nlohmann::ordered_json{{"format", kFormat},
                                    {"version", kVersion},
                                    {"kind", arrays.kind},
                                    {"kind_version", arrays.version},
                                    {"attributes", arrays.attributes}}
                 .dump();
  } catch (const nlohmann::json::exception&) {
    return fail(ErrorCode::internal, "cannot write derived data", arrays.kind, "its attributes are not valid UTF-8");
  }
  std::map<std::string, CompressedColumn> compressed;  // the file has them by name
  for (const auto& column : arrays.columns) {
    RAYFIELD_ASSIGN(
        compressed[column.first],
        std::visit([&](const auto& values) { return compress_values(column.first, values); }, column.second));
  }
  for (const auto& [name, source] : streamed) {
    RAYFIELD_ASSIGN(compressed[name], compress_source(name, source));
  }
  std::vector<ImageColumn> columns;
  for (auto& [name, column] : compressed) columns.push_back(std::move(column.column));
  return build_image(header, columns);
}

Result<ArraySet> decode_arrays(std::span<const std::byte> image, const std::string& where) {
  RAYFIELD_ASSIGN(const ImageLayout layout, read_layout(image, where));
  RAYFIELD_ASSIGN(ArraySet arrays, decode_header(layout, where));
  const FetchChunk fetch = [image](const ChunkPlace& place) -> Result<std::span<const std::byte>> {
    return image.subspan(place.offset, place.size);
  };
  for (const ColumnLayout& column : layout.columns) {
    RAYFIELD_ASSIGN(Array array, decode_column(column, fetch, where));
    arrays.columns.emplace(column.name, std::move(array));
  }
  return arrays;
}

}  // namespace rayfield::tile
