#include "rayfield/core/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace rayfield {
namespace {

using ::testing::HasSubstr;

std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

// Each was the end of the program, out of stack, in the parser or when its tree was freed.
TEST(CheckTomlText, KeysOfManyPartsAreRefusedWithTheirLine) {
  const std::string deep = "a" + repeated(".a", 50000);
  for (const std::string& text :
       {"x = 1\n" + deep + " = 1\n", "\n[" + deep + "]\n", "\n[[" + deep + "]]\n",
        "\nx = { y = 1, " + deep + " = 1 }\n", "\n" + repeated("\"a\" . ", 50000) + "a = 1"}) {
    const auto checked = check_toml_text(text, "bad rig", "rig.toml");
    ASSERT_FALSE(checked) << text.substr(0, 40);
    EXPECT_EQ(checked.error().code, ErrorCode::usage);
    EXPECT_EQ(checked.error().where, "rig.toml, line 2");
    EXPECT_THAT(checked.error().why, HasSubstr("more than 30 parts"));
  }
}

TEST(CheckTomlText, DotsInStringsCommentsAndListsAreNoKeys) {
  const std::string dots(1000, '.');
  for (const std::string& text : {"a = \"" + dots + "\\\"" + dots + "\"\n", "a = '" + dots + "'\n", "# " + dots + "\n",
                                  "a = 1 # \"" + dots + "\nb = 2\n", "a = [" + repeated("1.5, ", 1000) + "1.5]\n",
                                  repeated("a.b.c = 1.5\n", 1000)})
    EXPECT_TRUE(check_toml_text(text, "bad rig", "rig.toml")) << text.substr(0, 40);
}

TEST(CheckTomlText, ControlCharactersAreRefusedWithTheirLine) {
  const auto checked = check_toml_text("a = 1\nb = \x01\n", "bad rig", "rig.toml");
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().where, "rig.toml, line 2");
}

}  // namespace
}  // namespace rayfield
