#include "libtile/hdf5/array_image.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libtile/hdf5/column_codec.h"
#include "libtile/hdf5/h5_layout.h"
#include "libtile/hdf5/h5_read.h"
#include "libtile/hdf5/h5_write.h"

namespace rayfield::tile {
namespace {

constexpr std::size_t kUsualCompression = 1024;
constexpr const char* kFormat = "rayfield-arrays";
constexpr int kVersion = 1;

template <class T>
constexpr ElementType type_of() {
  if constexpr (std::is_same_v<T, std::uint8_t>) return ElementType::u8;
  if constexpr (std::is_same_v<T, std::uint16_t>) return ElementType::u16;
  if constexpr (std::is_same_v<T, std::int32_t>) return ElementType::i32;
  if constexpr (std::is_same_v<T, std::uint32_t>) return ElementType::u32;
  if constexpr (std::is_same_v<T, std::int64_t>) return ElementType::i64;
  if constexpr (std::is_same_v<T, float>) return ElementType::f32;
  if constexpr (std::is_same_v<T, double>) return ElementType::f64;
}

tl::unexpected<Error> damaged(const std::string& where, const std::string& why) {
  return fail(ErrorCode::damaged, "cannot read derived data", where, why, "run `rayfield verify`");
}

// One column, its chunks compressed one after the other into `storage`.
struct CompressedColumn {
  ImageColumn column;
  std::vector<std::byte> storage;
};

template <class T>
CompressedColumn compress_column(const std::string& name, const std::vector<T>& values) {
  CompressedColumn result;
  result.column.name = name;
  result.column.type = type_of<T>();
  result.column.count = values.size();
  const std::size_t chunk = std::clamp<std::size_t>(values.size(), 1, kMostChunkElements);
  result.column.chunk_elements = chunk;
  std::vector<std::size_t> sizes;
  for (std::size_t first = 0; first < values.size(); first += chunk) {
    const std::size_t count = std::min(chunk, values.size() - first);
    std::vector<T> padded;
    std::span<const T> part(values.data() + first, count);
    if (count < chunk) {
      padded.assign(part.begin(), part.end());
      padded.resize(chunk);
      part = padded;
    }
    sizes.push_back(compress(std::as_bytes(part), sizeof(T), result.storage));
  }
  std::size_t offset = 0;
  for (const std::size_t size : sizes) {
    result.column.chunks.push_back(std::span<const std::byte>(result.storage).subspan(offset, size));
    offset += size;
  }
  return result;
}

// Room for the claimed length is reserved where a file of that size can have it; beyond that, memory grows with what is
// really decompressed.
template <class T>
Result<Array> read_values(std::span<const std::byte> image, const ColumnLayout& column, const std::string& where) {
  std::vector<T> values;
  values.reserve(std::min<std::uint64_t>(column.count, image.size() * kUsualCompression / sizeof(T)));
  std::vector<T> padded;
  for (const ChunkPlace& chunk : column.chunks) {
    const std::size_t first = values.size();
    const std::size_t count = std::min<std::uint64_t>(column.chunk_elements, column.count - first);
    values.resize(first + count);
    std::span<T> target(values.data() + first, count);
    if (count < column.chunk_elements) {
      padded.resize(column.chunk_elements);
      target = padded;
    }
    const auto blob = image.subspan(chunk.offset, chunk.size);
    if (!decompress(blob, std::as_writable_bytes(target)))
      return damaged(where, "column '" + column.name + "' cannot be decompressed");
    if (count < column.chunk_elements)
      std::copy_n(padded.begin(), count, values.begin() + static_cast<std::ptrdiff_t>(first));
  }
  return Array(std::move(values));
}

Result<Array> read_any(std::span<const std::byte> image, const ColumnLayout& column, const std::string& where) {
  switch (column.type) {
    case ElementType::u8:
      return read_values<std::uint8_t>(image, column, where);
    case ElementType::u16:
      return read_values<std::uint16_t>(image, column, where);
    case ElementType::i32:
      return read_values<std::int32_t>(image, column, where);
    case ElementType::u32:
      return read_values<std::uint32_t>(image, column, where);
    case ElementType::i64:
      return read_values<std::int64_t>(image, column, where);
    case ElementType::f32:
      return read_values<float>(image, column, where);
    case ElementType::f64:
      return read_values<double>(image, column, where);
    case ElementType::u64:
      break;
  }
  return damaged(where, "column '" + column.name + "' has a type that derived data does not use");
}

Result<void> read_attributes(const std::string& text, ArraySet& arrays, const std::string& where) {
  try {
    const nlohmann::json json = nlohmann::json::parse(text);
    if (json.at("format") != kFormat) return damaged(where, "it holds no derived data");
    if (json.at("version") != kVersion) return damaged(where, "it was written by a newer version of rayfield");
    arrays.kind = json.at("kind").get<std::string>();
    arrays.version = json.at("kind_version").get<int>();
    arrays.attributes = json.at("attributes").get<std::string>();
  } catch (const nlohmann::json::exception& e) {
    return damaged(where, std::string("its attributes are not what they should be: ") + e.what());
  }
  return {};
}

}  // namespace

Result<std::vector<std::byte>> encode_arrays(const ArraySet& arrays) {
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
  std::vector<CompressedColumn> compressed;
  compressed.reserve(arrays.columns.size());
  for (const auto& column : arrays.columns)
    compressed.push_back(
        std::visit([&](const auto& values) { return compress_column(column.first, values); }, column.second));
  std::vector<ImageColumn> columns;
  for (CompressedColumn& c : compressed) columns.push_back(std::move(c.column));
  return build_image(header, columns);
}

Result<ArraySet> decode_arrays(std::span<const std::byte> image, const std::string& where) {
  RAYFIELD_ASSIGN(const ImageLayout layout, read_layout(image, where));
  ArraySet arrays;
  RAYFIELD_CHECK(read_attributes(layout.attributes, arrays, where));
  for (const ColumnLayout& column : layout.columns) {
    RAYFIELD_ASSIGN(Array array, read_any(image, column, where));
    arrays.columns.emplace(column.name, std::move(array));
  }
  return arrays;
}

}  // namespace rayfield::tile
