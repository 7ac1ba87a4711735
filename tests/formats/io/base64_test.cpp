#include "formats/io/base64.h"

#include <gtest/gtest.h>

#include <string>

namespace rayfield::formats {
namespace {

std::string encoded(const std::string& text) { return base64(std::as_bytes(std::span(text))); }

// RFC 4648, section 10.
TEST(Base64, EncodesTheExamplesOfItsStandard) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(Base64, TakesAnyByte) { EXPECT_EQ(encoded(std::string("\xff\xef\x00\xfb\xf0", 5)), "/+8A+/A="); }

}  // namespace
}  // namespace rayfield::formats
