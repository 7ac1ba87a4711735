#include "formats/report/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace rayfield::formats {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(FillTemplate, PutsPartsInAndLeavesTheRest) {
  EXPECT_EQ(fill_template("<h1>{{a}}</h1>{{b}}.", {{"a", "1"}, {"b", "2"}}), "<h1>1</h1>2.");
  EXPECT_EQ(fill_template("{{a}}{{a}} { } }}", {{"a", "x"}}), "xx { } }}");
}

TEST(FillTemplate, NeverLooksAtAPartAgain) {
  EXPECT_EQ(fill_template("{{a}} {{b}}", {{"a", "{{b}}"}, {"b", "{{a}}"}}), "{{b}} {{a}}");
}

// printf "alert('Hello, world.');" | openssl dgst -sha256 -binary | base64: the example of the CSP standard, level 2.
TEST(CspHash, IsThatOfTheStandardsExample) {
  EXPECT_EQ(csp_hash("alert('Hello, world.');"), "sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng=");
}

TEST(JsonForScript, CannotEndItsElementOrOpenAComment) {
  const std::string json = json_for_script(R"({"a":"</script><!--","b":"x\u003cy"})");
  EXPECT_EQ(json, R"({"a":"\u003c/script>\u003c!--","b":"x\u003cy"})");
}

TEST(JsonForScript, EscapesLineSeparatorsOfJavaScript) {
  EXPECT_EQ(json_for_script("\"\xE2\x80\xA8\xE2\x80\xA9\""), R"("\u2028\u2029")");
}

std::string between(const std::string& text, const std::string& open, const std::string& close, std::size_t from = 0) {
  const std::size_t begin = text.find(open, from) + open.size();
  return text.substr(begin, text.find(close, begin) - begin);
}

TEST(Page, ItsPolicyAllowsExactlyItsOneStyleAndItsOneScript) {
  const std::string html = page({{"title", "t"},
                                 {"software", "s"},
                                 {"heading", "h"},
                                 {"subheading", "h"},
                                 {"tiles", ""},
                                 {"look", ""},
                                 {"ends", ""},
                                 {"gaps", ""},
                                 {"quality", ""},
                                 {"footer", ""}},
                                "{}");
  const std::string policy = between(html, "http-equiv=\"Content-Security-Policy\" content=\"", "\"");
  EXPECT_THAT(policy, HasSubstr("default-src 'none'"));
  EXPECT_THAT(policy, Not(HasSubstr("unsafe")));
  EXPECT_THAT(policy, HasSubstr("style-src '" + csp_hash(between(html, "<style>", "</style>")) + "'"));
  const std::size_t script = html.rfind("<script>");
  EXPECT_THAT(policy, HasSubstr("script-src '" + csp_hash(between(html, "<script>", "</script>", script)) + "'"));
  EXPECT_EQ(html.find("<script>"), script) << "there is one script, beside the data";
  EXPECT_THAT(html, Not(HasSubstr("{{"))) << "every part of the template is filled";
  EXPECT_LT(html.find("Content-Security-Policy"), html.find("<style>"));
}

}  // namespace
}  // namespace rayfield::formats
