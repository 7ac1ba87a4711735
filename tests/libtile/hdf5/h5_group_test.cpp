#include "libtile/hdf5/h5_group.h"

#include <gmock/gmock.h>

#include "libtile/hdf5/array_image.h"
#include "tests/libtile/hdf5/h5_reference.h"

namespace rayfield::tile::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Bytes = std::vector<std::byte>;

TEST(H5Group, LinksInForeignFilesAreNotFollowed) {
  ForeignSteps soft;
  soft.column = [](hid_t group) { H5Lcreate_soft("/attributes", group, "v", H5P_DEFAULT, H5P_DEFAULT); };
  expect_refused("soft link", soft.image(), "a link to elsewhere");
  ForeignSteps external;
  external.column = [](hid_t group) { H5Lcreate_external("/etc/passwd", "/x", group, "v", H5P_DEFAULT, H5P_DEFAULT); };
  expect_refused("external link", external.image(), "kind 0x10");
}

// Two columns "a" and "b", and the places of their group's heap and node.
struct SealedGroup {
  Bytes image;
  std::size_t heap, node;

  SealedGroup() {
    ArraySet arrays;
    arrays.kind = "k";
    arrays.columns["a"] = std::vector<std::uint8_t>{1, 2, 3};
    arrays.columns["b"] = std::vector<std::uint8_t>{4, 5, 6};
    image = encode_arrays(arrays).value();
    heap = place_of(image, "HEAP", 1);
    node = place_of(image, "SNOD", 1);
  }
};

template <class T>
void expect_claim_refused(std::size_t SealedGroup::*what, std::size_t offset, T claim, const char* why) {
  SealedGroup group;
  put(group.image, group.*what + offset, claim);
  const auto layout = read_layout(resealed(unsealed(group.image)), "claim");
  ASSERT_FALSE(layout) << why << ' ' << claim;
  EXPECT_EQ(layout.error().code, ErrorCode::damaged);
  EXPECT_THAT(layout.error().line(), AllOf(HasSubstr("claim at byte "), HasSubstr(why)));
}

TEST(H5Group, NamesOutsideOfTheFileAreRefused) {
  ASSERT_TRUE(read_layout(resealed(unsealed(SealedGroup().image)), "sound"));
  for (const std::uint64_t claim : {std::uint64_t{1} << 20U, ~std::uint64_t{0}}) {
    expect_claim_refused(&SealedGroup::heap, 8, claim, "names are not as");             // bytes of the texts
    expect_claim_refused(&SealedGroup::heap, 24, claim, "names are not as");            // their address
    expect_claim_refused(&SealedGroup::node, 8, claim, "outside of its group");         // place of the first text
    expect_claim_refused(&SealedGroup::node, 16, claim, "does not fit into the file");  // its object
  }
  expect_claim_refused(&SealedGroup::heap, 8, std::uint64_t{9}, "none that rayfield gives");  // "a" has no end
}

TEST(H5Group, NodesThatClaimTooManyNamesOrOneNameTwiceAreRefused) {
  for (const std::uint16_t claim : {std::uint16_t{0}, std::uint16_t{17}, std::uint16_t{65535}})
    expect_claim_refused(&SealedGroup::node, 6, claim, "not as rayfield writes it");
  expect_claim_refused(&SealedGroup::node, 8 + 40, std::uint64_t{8}, "out of order");         // "b" is "a" once more
  expect_claim_refused(&SealedGroup::node, 6, std::uint16_t{3}, "none that rayfield gives");  // a name of no letters
}

TEST(H5Group, TwoNamesOfOneColumnAreRefused) {
  SealedGroup group;
  std::uint64_t object = 0;
  std::memcpy(&object, group.image.data() + group.node + 16, sizeof(object));
  expect_claim_refused(&SealedGroup::node, 16 + 40, object, "share bytes");
}

}  // namespace
}  // namespace rayfield::tile::testing
