#include "cli/console/option_settings.h"

#include <gtest/gtest.h>

namespace rayfield::cli {
namespace {

TEST(OptionSettings, ValuesAreTakenForWhatTheyLookLike) {
  EXPECT_EQ(parse_option_value("true"), OptionValue(true));
  EXPECT_EQ(parse_option_value(" 2.5 "), OptionValue(2.5));
  EXPECT_EQ(parse_option_value("-1e-3"), OptionValue(-1e-3));
  EXPECT_EQ(parse_option_value("[0.3, 0.6,1.2]"), OptionValue(std::vector<double>{0.3, 0.6, 1.2}));
  EXPECT_EQ(parse_option_value("[]"), OptionValue(std::vector<double>{}));
  EXPECT_EQ(parse_option_value("spherical"), OptionValue(std::string("spherical")));
  EXPECT_EQ(parse_option_value("2.5m"), OptionValue(std::string("2.5m")));
  EXPECT_EQ(parse_option_value("[1, two]"), OptionValue(std::string("[1, two]")));
  EXPECT_EQ(parse_option_value(""), OptionValue(std::string()));
}

TEST(OptionSettings, ASettingWithoutKeyOrValueIsRefused) {
  EXPECT_EQ(parse_setting("posts.min_contrast = 2.5")->first, "posts.min_contrast");
  EXPECT_EQ(parse_setting("a=b=c")->second, OptionValue(std::string("b=c")));
  for (const char* wrong : {"posts.min_contrast", "=2", ""}) {
    const auto setting = parse_setting(wrong);
    ASSERT_FALSE(setting) << wrong;
    EXPECT_EQ(setting.error().code, ErrorCode::usage);
  }
}

}  // namespace
}  // namespace rayfield::cli
