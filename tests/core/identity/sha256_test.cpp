#include "rayfield/core/sha256.h"

#include <gtest/gtest.h>

#include "rayfield/core/uuid.h"

namespace rayfield {
namespace {

// FIPS 180-4 examples.
TEST(Sha256, GivesTheStandardsExampleDigests) {
  EXPECT_EQ(sha256_hex(std::string_view("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex(std::string_view("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Sha256, DoesNotDependOnHowTheInputIsCut) {
  Sha256 hash;
  hash.update(std::string_view("a"));
  hash.update(std::string_view("bc"));
  EXPECT_EQ(hash.hex(), sha256_hex(std::string_view("abc")));
}

TEST(NamedUuid, HasTheRfc4122FormAndDependsOnBothNames) {
  const std::string uuid = named_uuid("space", "name");
  ASSERT_EQ(uuid.size(), 36U);
  EXPECT_EQ(uuid[8], '-');
  EXPECT_EQ(uuid[14], '8');
  EXPECT_NE(std::string("89ab").find(uuid[19]), std::string::npos);
  EXPECT_EQ(uuid, named_uuid("space", "name"));
  EXPECT_NE(uuid, named_uuid("spac", "ename"));
  EXPECT_NE(uuid, named_uuid("space", "name2"));
}

}  // namespace
}  // namespace rayfield
