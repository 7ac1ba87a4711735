#include "libtile/hdf5/h5_group.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "libtile/hdf5/h5_layout.h"
#include "libtile/hdf5/h5_object.h"
#include "libtile/hdf5/h5_tree.h"
#include "rayfield/core/byte_cursor.h"

/// A group is a symbol table: a tree of nodes that hold its names in ascending order, and a heap with the names' texts.
///
///   message     tree u64   heap u64
///   heap        "HEAP"   version u8 = 0   3 bytes   bytes of the texts u64   u64   address of the texts u64
///   node        "SNOD"   version u8 = 1   u8   names u16   then 2 K entries
///   entry       text u64   object's header u64   cached u32 (2: a link to elsewhere)   u32   16 bytes
namespace rayfield::tile {
namespace {

constexpr std::size_t kHeapBytes = 32;
constexpr std::size_t kMostNodeNames = 2 * kSymbolNodeK;
constexpr std::size_t kNodeHeadBytes = 8, kEntryBytes = 40;
constexpr std::uint32_t kMostCached = 1;  // 0: nothing is cached in the entry, 1: the address of a group's table

struct Heap {
  std::uint64_t texts = 0, size = 0;
};

Result<Heap> read_heap(H5Bytes& bytes, std::uint64_t offset) {
  RAYFIELD_ASSIGN(const auto content, bytes.view(offset, kHeapBytes));
  ByteCursor cursor(content);
  const auto mark = cursor.take(4);
  const auto version = cursor.get<std::uint8_t>();
  cursor.skip(3);
  Heap heap;
  heap.size = cursor.get<std::uint64_t>();
  cursor.skip(8);
  heap.texts = cursor.get<std::uint64_t>();
  if (std::memcmp(mark.data(), "HEAP", mark.size()) != 0 || version != 0 || !bytes.contains(heap.texts, heap.size))
    return bytes.refuse(offset, "a group's names are not as rayfield writes them");
  return heap;
}

Result<std::string> read_name(H5Bytes& bytes, const Heap& heap, std::uint64_t text, std::uint64_t entry) {
  if (text >= heap.size) return bytes.refuse(entry, "a name lies outside of its group's names");
  RAYFIELD_ASSIGN(const auto content,
                  bytes.view(heap.texts + text, std::min<std::uint64_t>(heap.size - text, kMostNameBytes + 1)));
  const std::string_view letters(reinterpret_cast<const char*>(content.data()), content.size());
  const std::size_t end = letters.find('\0');
  const std::string_view name = letters.substr(0, end);
  if (end == std::string_view::npos || name.empty() || name == "." || name.find('/') != std::string_view::npos)
    return bytes.refuse(entry, "a name is none that rayfield gives");
  return std::string(name);
}

Result<void> read_symbol_node(H5Bytes& bytes, std::uint64_t offset, const Heap& heap, std::size_t most,
                              std::vector<H5Name>& names) {
  std::array<std::byte, kNodeHeadBytes + kMostNodeNames * kEntryBytes> node{};
  RAYFIELD_ASSIGN(const auto content, bytes.view(offset, node.size()));
  std::copy(content.begin(), content.end(), node.begin());
  ByteCursor cursor(node);
  const auto mark = cursor.take(4);
  const auto version = cursor.get<std::uint8_t>();
  cursor.skip(1);
  const std::size_t count = cursor.get<std::uint16_t>();
  if (std::memcmp(mark.data(), "SNOD", mark.size()) != 0 || version != 1 || count == 0 || count > kMostNodeNames)
    return bytes.refuse(offset, "a node of a group is not as rayfield writes it");
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t entry = offset + kNodeHeadBytes + i * kEntryBytes;
    const auto text = cursor.get<std::uint64_t>();
    const auto object = cursor.get<std::uint64_t>();
    const auto cached = cursor.get<std::uint32_t>();
    cursor.skip(20);
    if (cached > kMostCached) return bytes.refuse(entry, "a name in a group is a link to elsewhere");
    RAYFIELD_ASSIGN(std::string name, read_name(bytes, heap, text, entry));
    if (!names.empty() && names.back().name >= name)
      return bytes.refuse(entry, "the names of a group are out of order");
    if (names.size() == most) return bytes.refuse(entry, "a group has more names than rayfield gives");
    names.push_back({std::move(name), object});
  }
  return {};
}

}  // namespace

Result<std::vector<H5Name>> read_group(H5Bytes& bytes, std::uint64_t offset, std::size_t most) {
  constexpr std::array kAllowed = {H5MessageKind::symbol_table};
  RAYFIELD_ASSIGN(const H5ObjectHeader header, read_object_header(bytes, offset, kAllowed));
  const H5Message* table = header.find(H5MessageKind::symbol_table);
  if (table == nullptr || table->body.size() < 16) return bytes.refuse(offset, "a group has no table of names");
  ByteCursor cursor(table->body);
  const auto tree = cursor.get<std::uint64_t>();
  const auto heap_offset = cursor.get<std::uint64_t>();
  RAYFIELD_ASSIGN(const Heap heap, read_heap(bytes, heap_offset));
  std::vector<H5Name> names;
  RAYFIELD_CHECK(walk_tree(bytes, tree, H5TreeKind::names, [&](const H5TreeEntry& entry) {
    return read_symbol_node(bytes, entry.child, heap, most, names);
  }));
  return names;
}

}  // namespace rayfield::tile
