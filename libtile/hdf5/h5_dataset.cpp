#include "libtile/hdf5/h5_dataset.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "libtile/hdf5/column_codec.h"
#include "libtile/hdf5/h5_layout.h"
#include "libtile/hdf5/h5_object.h"
#include "libtile/hdf5/h5_tree.h"
#include "rayfield/core/byte_cursor.h"

/// What messages say of a dataset, each in the one form in which rayfield writes it:
///
///   dataspace   one value: 1 0 0 0, 4 bytes;   a list: 1 1 1 0, 4 bytes, elements u64, the same again
///   datatype    0x13 0x11 0 0, bytes u32 (text in UTF-8, padded with zeros); numbers: see number_message()
///   layout      in one piece: 3 1, address u64, bytes u64;   chunks: 3 2 2, tree u64, elements u32, element bytes u32
///   filters     1 1, 6 bytes, filter u16, 0 u16, flags u16, values u16, the values
///
/// Fill values are never written, and say nothing.
namespace rayfield::tile {
namespace {

using Bytes = std::span<const std::byte>;
using Kind = H5MessageKind;
constexpr std::array kAllowed = {Kind::dataspace, Kind::datatype, Kind::fill_value, Kind::layout, Kind::filters};

constexpr std::uint64_t kNoAddress = ~std::uint64_t{0};

struct Dataset {
  H5ObjectHeader header;
  Bytes dataspace, datatype, layout, filters;
  std::uint64_t offset_of(Kind kind) const { return header.find(kind)->offset; }
};

Result<Dataset> read_dataset(H5Bytes& bytes, std::uint64_t offset) {
  Dataset dataset;
  RAYFIELD_ASSIGN(dataset.header, read_object_header(bytes, offset, kAllowed));
  const auto body_of = [&](Kind kind) {
    const H5Message* message = dataset.header.find(kind);
    return message == nullptr ? Bytes() : message->body;
  };
  dataset.dataspace = body_of(Kind::dataspace);
  dataset.datatype = body_of(Kind::datatype);
  dataset.layout = body_of(Kind::layout);
  dataset.filters = body_of(Kind::filters);
  if (dataset.dataspace.empty() || dataset.datatype.empty() || dataset.layout.empty())
    return bytes.refuse(offset, "it is no dataset as rayfield writes it");
  return dataset;
}

template <std::size_t N>
bool starts_with(Bytes bytes, const std::array<unsigned char, N>& prefix) {
  return bytes.size() >= N && std::equal(prefix.begin(), prefix.end(), bytes.begin(),
                                         [](unsigned char a, std::byte b) { return std::byte{a} == b; });
}

// A type of numbers, little-endian. Integers: class 0x10; 8 where signed, 0, 0; bytes u32; first bit and bits u16.
// Floating point: class 0x11; 0x20 (implied leading bit), place of the sign, 0; bytes u32; first bit and bits u16;
// place and bits of the exponent, of the mantissa u8; bias u32.
std::vector<std::byte> number_message(ElementType type) {
  const auto size = static_cast<std::uint32_t>(element_size(type));
  const auto bits = static_cast<std::uint16_t>(8 * size);
  const bool floating = type == ElementType::f32 || type == ElementType::f64;
  const bool is_signed = type == ElementType::i32 || type == ElementType::i64;
  ByteBuilder message;
  const auto put_bytes = [&](std::initializer_list<int> values) {
    for (const int value : values) message.put(static_cast<std::uint8_t>(value));
  };
  put_bytes(floating ? std::initializer_list<int>{0x11, 0x20, bits - 1, 0}
                     : std::initializer_list<int>{0x10, is_signed ? 8 : 0, 0, 0});
  message.put(size);
  message.put(std::uint16_t{0});
  message.put(bits);
  if (type == ElementType::f32) put_bytes({23, 8, 0, 23, 127, 0, 0, 0});
  if (type == ElementType::f64) put_bytes({52, 11, 0, 52, 0xFF, 3, 0, 0});
  return {message.bytes().begin(), message.bytes().end()};
}

std::optional<ElementType> number_type(Bytes message) {
  for (const ElementType type : {ElementType::u8, ElementType::u16, ElementType::i32, ElementType::u32,
                                 ElementType::i64, ElementType::u64, ElementType::f32, ElementType::f64}) {
    const std::vector<std::byte> expected = number_message(type);
    if (message.size() >= expected.size() && std::equal(expected.begin(), expected.end(), message.begin())) return type;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> list_length(Bytes message) {
  if (!starts_with(message, std::array<unsigned char, 4>{1, 1, 1, 0}) || message.size() < 24) return std::nullopt;
  ByteCursor cursor(message.subspan(8));
  const auto length = cursor.get<std::uint64_t>(), most = cursor.get<std::uint64_t>();
  return length == most ? std::optional(length) : std::nullopt;
}

struct Piece {
  std::uint64_t address = 0, size = 0;
};

std::optional<Piece> one_piece(Bytes message) {
  if (!starts_with(message, std::array<unsigned char, 2>{3, 1}) || message.size() < 18) return std::nullopt;
  ByteCursor cursor(message.subspan(2));
  Piece piece;
  piece.address = cursor.get<std::uint64_t>();
  piece.size = cursor.get<std::uint64_t>();
  return piece;
}

struct Chunking {
  std::uint64_t tree = 0;
  std::uint32_t elements = 0, element_bytes = 0;
};

std::optional<Chunking> chunking(Bytes message) {
  if (!starts_with(message, std::array<unsigned char, 3>{3, 2, 2}) || message.size() < 19) return std::nullopt;
  ByteCursor cursor(message.subspan(3));
  Chunking result;
  result.tree = cursor.get<std::uint64_t>();
  result.elements = cursor.get<std::uint32_t>();
  result.element_bytes = cursor.get<std::uint32_t>();
  return result;
}

// Blosc and nothing else. Its values are those of the registered filter; the buffers themselves say it all again.
bool is_blosc(Bytes message) {
  if (!starts_with(message, std::array<unsigned char, 2>{1, 1})) return false;
  ByteCursor cursor(message.subspan(2));
  cursor.skip(6);
  const auto filter = cursor.get<std::uint16_t>(), name_bytes = cursor.get<std::uint16_t>();
  cursor.skip(2);  // optional or not: chunks are never written without it
  const std::size_t values = cursor.get<std::uint16_t>();
  cursor.skip(4 * values);
  return !cursor.failed() && filter == kBloscFilter && name_bytes == 0;
}

// The chunks' places in order. Their number is that of the entries found, so a claimed length alone takes no memory.
Result<void> read_chunks(H5Bytes& bytes, std::uint64_t tree, ColumnLayout& column, std::uint64_t& unclaimed) {
  const std::uint64_t expected = (column.count - 1) / column.chunk_elements + 1;
  RAYFIELD_CHECK(walk_tree(bytes, tree, H5TreeKind::chunks, [&](const H5TreeEntry& entry) -> Result<void> {
    ByteCursor key(entry.key);
    const auto size = key.get<std::uint32_t>(), left_out_filters = key.get<std::uint32_t>();
    const auto first = key.get<std::uint64_t>(), within_element = key.get<std::uint64_t>();
    if (column.chunks.size() == expected || first != column.chunks.size() * column.chunk_elements ||
        within_element != 0)
      return bytes.refuse(entry.offset, "column '" + column.name + "' has a chunk out of place");
    if (left_out_filters != 0 || size < kLeastBufferBytes || size > unclaimed || !bytes.contains(entry.child, size))
      return bytes.refuse(entry.offset, "column '" + column.name + "' has a chunk that the file cannot hold");
    unclaimed -= size;
    column.chunks.push_back({entry.child, size});
    return {};
  }));
  if (column.chunks.size() != expected) return bytes.refuse(tree, "column '" + column.name + "' lacks chunks");
  return {};
}

}  // namespace

Result<std::string> read_text(H5Bytes& bytes, std::uint64_t offset) {
  RAYFIELD_ASSIGN(const Dataset dataset, read_dataset(bytes, offset));
  const bool is_scalar = starts_with(dataset.dataspace, std::array<unsigned char, 4>{1, 0, 0, 0});
  const bool is_text = starts_with(dataset.datatype, std::array<unsigned char, 4>{0x13, 0x11, 0, 0});
  if (!is_scalar || !is_text || dataset.datatype.size() < 8 || !dataset.filters.empty())
    return bytes.refuse(offset, "its attributes are not one text");
  const std::optional<Piece> piece = one_piece(dataset.layout);
  ByteCursor type(dataset.datatype.subspan(4));
  if (!piece || piece->size != type.get<std::uint32_t>())
    return bytes.refuse(dataset.offset_of(Kind::layout), "its attributes are not stored as rayfield stores them");
  RAYFIELD_ASSIGN(const auto text, bytes.view(piece->address, piece->size));
  return std::string(reinterpret_cast<const char*>(text.data()), text.size());
}

Result<ColumnLayout> read_column(H5Bytes& bytes, std::uint64_t offset, const std::string& name,
                                 std::uint64_t& unclaimed) {
  RAYFIELD_ASSIGN(const Dataset dataset, read_dataset(bytes, offset));
  const std::optional<ElementType> type = number_type(dataset.datatype);
  const std::optional<std::uint64_t> count = list_length(dataset.dataspace);
  if (!type || !count)
    return bytes.refuse(offset, "column '" + name + "' is not a list of numbers of a type that rayfield writes");
  ColumnLayout column;
  column.name = name;
  column.type = *type;
  column.count = *count;
  const auto foreign = [&](Kind kind) {
    return bytes.refuse(dataset.header.find(kind) == nullptr ? offset : dataset.offset_of(kind),
                        "column '" + name + "' is not stored as rayfield stores it");
  };
  if (column.count == 0) {
    const std::optional<Piece> piece = one_piece(dataset.layout);
    if (!piece || piece->size != 0) return foreign(Kind::layout);
    return column;
  }
  const std::optional<Chunking> chunks = chunking(dataset.layout);
  if (!chunks || chunks->elements == 0 || chunks->elements > kMostChunkElements ||
      chunks->element_bytes != element_size(column.type))
    return foreign(Kind::layout);
  if (!is_blosc(dataset.filters)) return foreign(Kind::filters);
  column.chunk_elements = chunks->elements;
  if (chunks->tree == kNoAddress)
    return bytes.refuse(dataset.offset_of(Kind::layout), "column '" + name + "' lacks chunks");
  RAYFIELD_CHECK(read_chunks(bytes, chunks->tree, column, unclaimed));
  return column;
}

}  // namespace rayfield::tile
