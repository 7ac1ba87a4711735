#include "libtile/hdf5/h5_tree.h"

#include <cstring>
#include <optional>
#include <vector>

#include "libtile/hdf5/h5_layout.h"
#include "rayfield/core/byte_cursor.h"

/// A node, whatever it holds, takes the space of a full one:
///
///   "TREE"   kind u8   level u8 (0: leaf)   entries u16   left u64   right u64
///   key 0   child 0 u64   key 1   child 1 u64   …   key n
namespace rayfield::tile {
namespace {

constexpr std::size_t kHeadBytes = 24;
constexpr std::size_t kSiblingsBytes = 16;
// With 8 children a node, more levels than the largest file has chunks for.
constexpr unsigned kMostLevels = 10;

struct Shape {
  std::size_t key_bytes, most_entries;
  std::size_t node_bytes() const { return kHeadBytes + most_entries * (key_bytes + 8) + key_bytes; }
};

Shape shape_of(H5TreeKind kind) {
  // A name's place in the heap; size, filter mask, first element and the offset within it.
  return kind == H5TreeKind::names ? Shape{8, 2 * kGroupTreeK} : Shape{24, 2 * kChunkTreeK};
}

struct Node {
  std::vector<std::byte> bytes;
  unsigned level = 0;
  std::vector<H5TreeEntry> entries;
};

// `level` is nothing for the root, the only node that may have any level, and none of a group's names.
Result<void> read_node(H5Bytes& bytes, std::uint64_t offset, H5TreeKind kind, std::optional<unsigned> level,
                       Node& node) {
  const Shape shape = shape_of(kind);
  RAYFIELD_ASSIGN(const auto content, bytes.view(offset, shape.node_bytes()));
  node.bytes.assign(content.begin(), content.end());
  node.entries.clear();
  ByteCursor cursor(node.bytes);
  const auto mark = cursor.take(4);
  const auto stated_kind = cursor.get<std::uint8_t>();
  node.level = cursor.get<std::uint8_t>();
  const std::size_t count = cursor.get<std::uint16_t>();
  cursor.skip(kSiblingsBytes);
  if (std::memcmp(mark.data(), "TREE", mark.size()) != 0 || stated_kind != static_cast<std::uint8_t>(kind))
    return bytes.refuse(offset, "it is no node of the tree that leads there");
  if (level ? node.level != *level : node.level > kMostLevels)
    return bytes.refuse(offset, "a node of a tree is not of the level that it should be");
  const bool may_be_empty = !level && node.level == 0 && kind == H5TreeKind::names;
  if (count > shape.most_entries || (count == 0 && !may_be_empty))
    return bytes.refuse(offset, "a node of a tree has a number of entries that it cannot have");
  for (std::size_t i = 0; i < count; ++i) {
    H5TreeEntry entry;
    entry.offset = offset + kHeadBytes + i * (shape.key_bytes + 8);
    entry.key = cursor.take(shape.key_bytes);
    entry.child = cursor.get<std::uint64_t>();
    node.entries.push_back(entry);
  }
  return {};
}

}  // namespace

Result<void> walk_tree(H5Bytes& bytes, std::uint64_t root, H5TreeKind kind,
                       const std::function<Result<void>(const H5TreeEntry&)>& visit) {
  struct Pending {
    std::uint64_t offset;
    std::optional<unsigned> level;
  };
  std::vector<Pending> pending{{root, std::nullopt}};
  Node node;
  while (!pending.empty()) {
    const Pending next = pending.back();
    pending.pop_back();
    RAYFIELD_CHECK(read_node(bytes, next.offset, kind, next.level, node));
    if (node.level == 0) {
      for (const H5TreeEntry& entry : node.entries) RAYFIELD_CHECK(visit(entry));
    } else {  // the last one first: it is taken last
      for (auto entry = node.entries.rbegin(); entry != node.entries.rend(); ++entry)
        pending.push_back({entry->child, node.level - 1});
    }
  }
  return {};
}

}  // namespace rayfield::tile
