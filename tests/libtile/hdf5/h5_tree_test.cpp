#include "libtile/hdf5/h5_tree.h"

#include <gmock/gmock.h>

#include <chrono>

#include "rayfield/core/byte_cursor.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::size_t kNodeBytes = 560;  // of a tree of chunks: 24, 16 entries of 32, a last key of 24

struct Entry {
  std::uint64_t first_element, child;
};

/// Nodes one after the other; node n is at n · 560.
class Tree {
 public:
  Tree& node(unsigned level, const std::vector<Entry>& entries, unsigned kind = 1) {
    const std::size_t begin = bytes_.size();
    bytes_.raw("TREE");
    bytes_.put(static_cast<std::uint8_t>(kind));
    bytes_.put(static_cast<std::uint8_t>(level));
    bytes_.put(static_cast<std::uint16_t>(entries.size()));
    bytes_.put(~std::uint64_t{0});
    bytes_.put(~std::uint64_t{0});
    for (std::size_t i = 0; i < std::min<std::size_t>(entries.size(), 16); ++i) {
      bytes_.put(std::uint64_t{0});
      bytes_.put(entries[i].first_element);
      bytes_.put(std::uint64_t{0});
      bytes_.put(entries[i].child);
    }
    while (bytes_.size() < begin + kNodeBytes) bytes_.put(std::uint8_t{0});
    return *this;
  }
  /// The children that the leaves lead to, in order; insists on rising keys, as the reader of chunks does.
  Result<void> walk(std::uint64_t root = 0) {
    H5Bytes bytes(bytes_.bytes(), "tree");
    children.clear();
    return walk_tree(bytes, root, H5TreeKind::chunks, [&](const H5TreeEntry& entry) -> Result<void> {
      ByteCursor key(entry.key);
      key.skip(8);
      if (key.get<std::uint64_t>() != children.size()) return bytes.refuse(entry.offset, "out of order");
      children.push_back(entry.child);
      return {};
    });
  }
  std::vector<std::uint64_t> children;

 private:
  ByteBuilder bytes_;
};

TEST(H5Tree, EntriesComeInOrderThroughAllLevels) {
  Tree tree;
  tree.node(2, {{0, 560}, {3, 1120}}).node(1, {{0, 1680}, {2, 2240}}).node(1, {{3, 2800}});
  tree.node(0, {{0, 10}, {1, 11}}).node(0, {{2, 12}}).node(0, {{3, 13}, {4, 14}});
  ASSERT_TRUE(tree.walk());
  EXPECT_THAT(tree.children, ElementsAre(10, 11, 12, 13, 14));
}

TEST(H5Tree, LoopsEnd) {
  Tree itself, each_other, parent;
  EXPECT_FALSE(itself.node(1, {{0, 0}}).walk());
  EXPECT_FALSE(each_other.node(1, {{0, 560}}).node(1, {{0, 0}}).walk());
  const auto walked = parent.node(2, {{0, 560}}).node(1, {{0, 0}}).walk();
  ASSERT_FALSE(walked);
  EXPECT_THAT(walked.error().line(), HasSubstr("tree at byte 0"));
}

// 16 to the power of 10 ways lead to the only leaf.
TEST(H5Tree, ManyWaysToOneNodeAreNotAllTaken) {
  Tree tree;
  for (unsigned level = 10; level > 0; --level)
    tree.node(level, std::vector<Entry>(16, {0, (11 - level) * kNodeBytes}));
  tree.node(0, {{0, 7}});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(tree.walk());
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  EXPECT_THAT(tree.children, ElementsAre(7));
}

TEST(H5Tree, NodesThatCannotBeAreRefused) {
  const std::vector<Entry> one = {{0, 1}};
  EXPECT_TRUE(Tree().node(0, one).walk());
  EXPECT_FALSE(Tree().node(0, {}).walk()) << "empty";
  EXPECT_FALSE(Tree().node(0, std::vector<Entry>(17, {0, 1})).walk()) << "more than full";
  EXPECT_FALSE(Tree().node(11, one).walk()) << "too high";
  EXPECT_FALSE(Tree().node(0, one, 0).walk()) << "of another kind";
  EXPECT_FALSE(Tree().node(1, {{0, 560}}).node(1, one).walk()) << "of another level";
}

TEST(H5Tree, AddressesOutsideOfTheFileAreRefused) {
  for (const std::uint64_t address : {std::uint64_t{1}, std::uint64_t{560}, std::uint64_t{1} << 63U, ~std::uint64_t{0},
                                      ~std::uint64_t{0} - kNodeBytes + 1}) {
    EXPECT_FALSE(Tree().node(1, {{0, address}}).walk()) << address;
    EXPECT_FALSE(Tree().node(0, {{0, 1}}).walk(address)) << address;
  }
}

}  // namespace
}  // namespace rayfield::tile::testing
